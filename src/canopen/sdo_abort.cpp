#include "canopen/sdo_abort.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "canopen/pdo.hpp"

namespace servoctl::canopen {
namespace {

struct Row {
  std::uint32_t code;
  std::string_view text;
  std::string_view hint;
};

constexpr std::string_view kCheckType =
    "check the object's type and size: `objects` shows what the dictionary says";
constexpr std::string_view kCheckName = "not in this firmware, or the dictionary in use is for another drive";
constexpr std::string_view kCheckRange =
    "`objects` with its index shows the limits; other settings may narrow them";
constexpr std::string_view kCheckState =
    "the drive accepts this only in another state: disable it or go to pre-operational, then try again";

constexpr std::array kRows{
    Row{0x0503'0000, "toggle bit not alternated",
        "try again; if it persists, look for a second master on the bus"},
    Row{0x0504'0000, "SDO protocol timed out", "try again; if it persists, check the bus load"},
    Row{0x0504'0001, "command specifier not valid or unknown",
        "the drive does not support this kind of transfer"},
    Row{0x0504'0002, "invalid block size", ""},
    Row{0x0504'0003, "invalid sequence number", ""},
    Row{0x0504'0004, "CRC error", "try again; if it persists, check wiring and termination"},
    Row{0x0504'0005, "out of memory", ""},
    Row{0x0601'0000, "unsupported access to an object", ""},
    Row{0x0601'0001, "attempt to read a write-only object", "it can be written, not read"},
    Row{0x0601'0002, "attempt to write a read-only object", "it can be read, not written"},
    Row{0x0602'0000, "object does not exist in the object dictionary", kCheckName},
    Row{0x0604'0041, "object cannot be mapped to the PDO", ""},
    Row{0x0604'0042, "number and length of the mapped objects exceed the PDO length", "a PDO holds 8 bytes"},
    Row{0x0604'0043, "general parameter incompatibility", ""},
    Row{0x0604'0047, "general internal incompatibility in the device", ""},
    Row{0x0606'0000, "access failed due to a hardware error", ""},
    Row{0x0607'0010, "data type does not match, length of service parameter does not match", kCheckType},
    Row{0x0607'0012, "data type does not match, length of service parameter too high", kCheckType},
    Row{0x0607'0013, "data type does not match, length of service parameter too low", kCheckType},
    Row{0x0609'0011, "sub-index does not exist", kCheckName},
    Row{0x0609'0030, "invalid value for parameter", kCheckRange},
    Row{0x0609'0031, "value of parameter written too high", kCheckRange},
    Row{0x0609'0032, "value of parameter written too low", kCheckRange},
    Row{0x0609'0036, "maximum value is less than minimum value", ""},
    Row{0x060A'0023, "resource not available: SDO connection", ""},
    Row{0x0800'0000, "general error", ""},
    Row{0x0800'0020, "data cannot be transferred or stored to the application", kCheckState},
    Row{0x0800'0021, "data cannot be transferred or stored to the application because of local control",
        "the panel or the vendor's software may hold control of the drive"},
    Row{0x0800'0022,
        "data cannot be transferred or stored to the application because of the present device state",
        kCheckState},
    Row{0x0800'0023, "object dictionary dynamic generation failed or no object dictionary is present", ""},
    Row{0x0800'0024, "no data available", ""},
};

/// What CANopen over EtherCAT has beside them (ETG.1000.6, table 41).
constexpr std::array kEtherCatRows{
    Row{0x0601'0003, "sub-index cannot be written unless sub-index 0 is 0",
        "write 0 to sub-index 0 first, then the entries, then their count"},
    Row{0x0601'0004, "complete access is not supported for an object of variable length",
        "access its entries one by one"},
    Row{0x0601'0005, "object is longer than the mailbox", ""},
    Row{0x0601'0006, "object is mapped to an RxPDO, download blocked",
        "it is written by the process data: write it in PRE-OP, or remove it from the PDO"},
    Row{0x0609'0033, "configured list of modules does not match the detected one", ""},
};

template <class Rows>
const Row* find_in(const Rows& rows, std::uint32_t code) {
  const auto row = std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return r.code == code; });
  return row == rows.end() ? nullptr : &*row;
}

const Row* find(std::uint32_t code) {
  const auto* row = find_in(kRows, code);
  return row != nullptr ? row : find_in(kEtherCatRows, code);
}

/// The error class of the high byte (ISO 9506, from which CiA 301 has it).
std::string_view class_text(std::uint32_t code) {
  switch (code >> 24U) {
    case 0x05: return "service error not listed in CiA 301";
    case 0x06: return "access error not listed in CiA 301";
    case 0x08: return "other error not listed in CiA 301";
    default: return "vendor-specific code, not listed in CiA 301";
  }
}

}  // namespace

std::string sdo_abort_text(std::uint32_t code) {
  const auto* row = find(code);
  return std::string(row != nullptr ? row->text : class_text(code));
}

std::string sdo_abort_hint(std::uint32_t code) {
  const auto* row = find(code);
  return row != nullptr ? std::string(row->hint) : "look the code up in the drive's manual";
}

std::string sdo_abort_hint(std::uint32_t code, ObjectAddress object) {
  const bool by_state =
      code == sdo_abort::kUnsupportedAccess || code == sdo_abort::kGeneral || code == sdo_abort::kDeviceState;
  if (by_state && pdo_at(object.index))
    return "a PDO must be changed in steps (invalid, count 0, entries, count): `pdo map` does so";
  if (by_state && object == ObjectAddress{0x1019, 0})
    return "it can change only while 1006h is 0: write 0 to 1006h, then this object, then the period again";
  if (code == sdo_abort::kIncompatible && object.index == 0x1016)
    return "another entry already monitors this node: write 0 to it first";
  return sdo_abort_hint(code);
}

bool refuses_block_transfer(std::uint32_t code) {
  switch (code) {
    case sdo_abort::kCommand:
    case sdo_abort::kBlockSize:
    case sdo_abort::kOutOfMemory:
    case sdo_abort::kUnsupportedAccess:
    case sdo_abort::kGeneral: return true;
    default: return false;
  }
}

bool is_standard_sdo_abort(std::uint32_t code) { return find_in(kRows, code) != nullptr; }

}  // namespace servoctl::canopen
