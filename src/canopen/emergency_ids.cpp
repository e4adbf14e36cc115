#include "canopen/emergency_ids.hpp"

#include "canopen/cob_id.hpp"
#include "canopen/cob_id_rules.hpp"
#include "canopen/pdo.hpp"

namespace servoctl::canopen {
namespace {

constexpr ObjectAddress kCobId{0x1014, 0};
constexpr std::uint32_t kNone = 0x8000'0000;  ///< Bit 31: no EMCY is sent.

}  // namespace

void EmergencyIds::learn(std::uint8_t node, std::uint32_t cob_id) {
  std::erase_if(changed_, [&](const Changed& entry) { return entry.node == node; });
  const auto can_id = cob_id & (kPdoExtended | kPdoCobIdMask);
  const bool usable = (cob_id & kNone) == 0 && can_id != 0 && cob_id_conflict(kCobId, cob_id, 0).empty();
  if (!usable) return;
  if (can_id == kEmergency + node)
    std::erase_if(changed_, [&](const Changed& entry) { return entry.can_id == can_id; });
  else
    changed_.push_back({node, can_id});
}

void EmergencyIds::on_boot_up(std::uint8_t node) {
  std::erase_if(changed_, [&](const Changed& entry) {
    return entry.node == node && entry.can_id > kEmergency && entry.can_id <= kEmergency + kLastNode;
  });
}

std::optional<Emergency> EmergencyIds::parse(const can::Frame& frame) const {
  if (changed_.empty()) return parse_emergency(frame);
  for (const auto& entry : changed_)
    if (entry.can_id == can_id_of(frame)) return parse_emergency(frame, entry.node);
  return parse_emergency(frame);
}

}  // namespace servoctl::canopen
