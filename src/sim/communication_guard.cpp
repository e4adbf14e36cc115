#include "sim/communication_guard.hpp"

#include "canopen/cob_id_rules.hpp"
#include "canopen/error_control.hpp"
#include "canopen/sdo_abort.hpp"
#include "drive/standard_objects.hpp"
#include "sim/heartbeat_consumer.hpp"

namespace servoctl::sim {
namespace abort = canopen::sdo_abort;

namespace {

constexpr std::uint32_t kBit31 = 0x8000'0000;
constexpr std::uint32_t kProduces = 0x4000'0000;     ///< Of 1005h and 1012h; reserved in 1014h.
constexpr std::uint32_t kBeyondCanId = 0x3FFF'F800;  ///< The frame bit and what only 29 bits need.
constexpr std::uint64_t kMostCounted = 240;

std::uint32_t check_can_id(std::uint32_t cob_id) {
  if ((cob_id & kBeyondCanId) != 0) return abort::kRange;
  return canopen::is_restricted(cob_id & canopen::kCanId) ? abort::kRange : 0;
}

std::uint32_t check_sync(std::uint32_t cob_id) {
  return (cob_id & kProduces) != 0 ? abort::kRange : check_can_id(cob_id);
}

}  // namespace

std::uint32_t CommunicationGuard::check(ObjectAddress object, ByteSpan data) const {
  const auto value = load_le(data);
  if (!values_->has(object) || value == values_->number(object)) return 0;
  const auto cob_id = static_cast<std::uint32_t>(value);
  if (object == objects::kSyncCobId) return check_sync(cob_id);
  if (object == objects::kTimeCobId) return check_time(cob_id);
  if (object == objects::kEmergencyCobId) return check_emergency(cob_id);
  if (object == objects::kSyncOverflow) return check_overflow(value);
  if (object.index == objects::kConsumerHeartbeatIndex && object.sub > 0)
    return check_consumer(object, static_cast<std::uint32_t>(value));
  return 0;
}

/// 1012h: bit 31, the drive takes TIME; its CAN-ID stays while it does. It is that of NMT in no case.
std::uint32_t CommunicationGuard::check_time(std::uint32_t cob_id) const {
  if ((cob_id & kProduces) != 0) return abort::kRange;
  const bool used = (cob_id & kBit31) != 0;
  const auto now = static_cast<std::uint32_t>(values_->number(objects::kTimeCobId));
  const bool stays = used && (now & kBit31) != 0;
  return stays && cob_id != now ? abort::kRange : check_can_id(cob_id);
}

/// 1014h: bit 31, the drive sends no EMCY; the CAN-ID stays while it does.
std::uint32_t CommunicationGuard::check_emergency(std::uint32_t cob_id) const {
  if ((cob_id & kProduces) != 0) return abort::kRange;
  const bool used = (cob_id & kBit31) == 0;
  if (!used && (cob_id & ~kBit31) == 0) return 0;
  const auto now = static_cast<std::uint32_t>(values_->number(objects::kEmergencyCobId));
  const bool stays = used && (now & kBit31) == 0;
  return stays && cob_id != now ? abort::kRange : check_can_id(cob_id);
}

/// 1019h: 0 or 2 to 240, and only while the communication cycle period is 0.
std::uint32_t CommunicationGuard::check_overflow(std::uint64_t value) const {
  if (value == 1 || value > kMostCounted) return abort::kRange;
  return values_->number(objects::kSyncPeriod) != 0 ? abort::kDeviceState : 0;
}

/// 1016h: no node is watched by two entries.
std::uint32_t CommunicationGuard::check_consumer(ObjectAddress object, std::uint32_t value) const {
  const auto node = canopen::watched_node(value);
  if (node == 0) return 0;
  for (std::uint8_t sub = 1; sub <= HeartbeatConsumer::kMost; ++sub) {
    const ObjectAddress other{object.index, sub};
    if (sub == object.sub || !values_->has(other)) continue;
    if (canopen::watched_node(static_cast<std::uint32_t>(values_->number(other))) == node)
      return abort::kIncompatible;
  }
  return 0;
}

}  // namespace servoctl::sim
