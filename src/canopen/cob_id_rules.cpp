#include "canopen/cob_id_rules.hpp"

#include <optional>
#include <string_view>

#include "base/format.hpp"
#include "canopen/cob_id.hpp"
#include "canopen/pdo.hpp"

namespace servoctl::canopen {
namespace {

constexpr std::uint32_t kInvalid = 0x8000'0000;
/// Bits 31 and 30 of 1012h: whether the device consumes and whether it produces TIME.
constexpr std::uint32_t kTimeUsed = 0xC000'0000;
constexpr std::uint32_t kExtended = 0x2000'0000;
constexpr std::uint32_t kBasicMask = 0x7FF;

/// The service whose COB-ID stands in an entry; `PDO` for those of PDOs. Empty for entries of other kinds.
std::string_view service_at(ObjectAddress object) {
  if (object == ObjectAddress{0x1005, 0}) return "SYNC";
  if (object == ObjectAddress{0x1012, 0}) return "TIME";
  if (object == ObjectAddress{0x1014, 0}) return "EMCY";
  const bool sdo = object.index >= 0x1200 && object.index <= 0x12FF;
  if (sdo && (object.sub == 1 || object.sub == 2)) return "SDO";
  const auto place = pdo_at(object.index);
  return place && !place->mapping && object.sub == 1 ? "PDO" : std::string_view();
}

bool in_use(std::string_view service, std::uint32_t cob_id) {
  if (service == "SYNC") return true;
  if (service == "TIME") return (cob_id & kTimeUsed) != 0;
  return (cob_id & kInvalid) == 0;
}

/// Whether a service may use a CAN-ID that the pre-defined connection set gives to it.
bool is_its_own(std::string_view service, std::uint32_t can_id, std::uint8_t node) {
  return service_of(can_id) == service && (service != "EMCY" || node == 0 || can_id == kEmergency + node);
}

}  // namespace

bool is_restricted(std::uint32_t can_id) {
  const auto service = service_of(can_id);
  return !service.empty() && service != "SYNC" && service != "TIME" && service != "EMCY";
}

std::string cob_id_conflict(ObjectAddress object, std::uint32_t cob_id, std::uint8_t node) {
  const auto service = service_at(object);
  if (service.empty() || !in_use(service, cob_id) || (cob_id & kExtended) != 0) return {};
  const auto can_id = cob_id & kBasicMask;
  const auto owner = service_of(can_id);
  if (owner.empty() || is_its_own(service, can_id, node)) return {};
  return formatted("CAN-ID 0x{:03X} belongs to {}{}", can_id, owner,
                   owner == service ? " of another node" : "");
}

}  // namespace servoctl::canopen
