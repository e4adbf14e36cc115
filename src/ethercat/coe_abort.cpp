#include "ethercat/coe_abort.hpp"

#include "canopen/sdo_abort.hpp"

namespace servoctl::ethercat {
namespace {

/// What says which objects are exchanged: mappings 1600h to 17FFh and 1A00h to 1BFFh, assignments 1C10h to
/// 1C2Fh.
bool is_about_pdos(std::uint16_t index) {
  return (index >= 0x1600 && index <= 0x17FF) || (index >= 0x1A00 && index <= 0x1BFF) ||
         (index >= 0x1C10 && index <= 0x1C2F);
}

}  // namespace

std::string coe_abort_hint(std::uint32_t code, ObjectAddress object, bool writes) {
  namespace abort = canopen::sdo_abort;
  const bool by_state =
      code == abort::kUnsupportedAccess || code == abort::kGeneral || code == abort::kDeviceState;
  if (writes && by_state && is_about_pdos(object.index))
    return "it can be changed in PRE-OP only (`state preop`), and in steps: count 0, entries, count";
  if (code == abort::kDeviceState || code == abort::kCannotStore)
    return "the drive accepts this in another state only: disable it or go to PRE-OP, then try again";
  if (code == abort::kPdoLength) return "the drive has no room for so many objects in one PDO";
  if (code == abort::kToggle) return "try again; if it persists, look for a second master on the network";
  if (code == abort::kTimeout)
    return "try again; the drive's own time limit for a step of the transfer expired";
  return canopen::sdo_abort_hint(code);
}

}  // namespace servoctl::ethercat
