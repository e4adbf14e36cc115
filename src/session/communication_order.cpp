#include "session/communication_order.hpp"

#include <algorithm>
#include <optional>

#include "canopen/error_control.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::session {
namespace {

constexpr std::uint32_t kBit31 = 0x8000'0000;
constexpr std::uint32_t kBit30 = 0x4000'0000;

std::uint32_t number(const Bytes& bytes) {
  return static_cast<std::uint32_t>(load_le(ByteSpan(bytes).first(std::min<std::size_t>(bytes.size(), 4))));
}

bool is_consumer(ObjectAddress object) {
  return object.index == objects::kConsumerHeartbeatIndex && object.sub > 0;
}

/// The COB-ID with its object switched off; empty for objects of other kinds, and for one that is off.
std::optional<std::uint32_t> switched_off(ObjectAddress object, std::uint32_t cob_id) {
  auto off = cob_id;
  if (object == objects::kSyncCobId) off = cob_id & ~kBit30;
  if (object == objects::kTimeCobId) off = cob_id & ~(kBit31 | kBit30);
  if (object == objects::kEmergencyCobId) off = cob_id | kBit31;
  return off == cob_id ? std::nullopt : std::optional(off);
}

/// What has to be out of the way before a write: the object itself as it must be first.
std::optional<Bytes> cleared(const PlannedWrite& write, const Bytes& present,
                             const std::vector<PlannedWrite>& writes) {
  if (is_consumer(write.object)) {
    const auto node = canopen::watched_node(number(present));
    const bool taken = node != 0 && std::any_of(writes.begin(), writes.end(), [&](const PlannedWrite& other) {
                         return is_consumer(other.object) && other.object != write.object &&
                                canopen::watched_node(number(other.data)) == node;
                       });
    return taken ? std::optional(Bytes(present.size(), 0)) : std::nullopt;
  }
  const auto now = switched_off(write.object, number(present));
  const auto then = switched_off(write.object, number(write.data));
  if (!now || !then || *now == *then) return std::nullopt;
  return store_le(*now, present.size());
}

/// The period is 0 while the counter changes, and gets its value behind it.
void hold_period(std::vector<PlannedWrite>& writes, std::vector<PlannedWrite>& first, const Values& present) {
  const auto at = [&](ObjectAddress object) {
    return std::find_if(writes.begin(), writes.end(), [&](const auto& w) { return w.object == object; });
  };
  const auto now = present.find(objects::kSyncPeriod);
  if (at(objects::kSyncOverflow) == writes.end() || now == present.end()) return;
  auto period = now->second;
  if (const auto planned = at(objects::kSyncPeriod); planned != writes.end()) {
    period = planned->data;
    writes.erase(planned);
  }
  if (number(now->second) != 0) first.push_back({objects::kSyncPeriod, Bytes(now->second.size(), 0)});
  if (number(period) != 0) writes.insert(at(objects::kSyncOverflow) + 1, {objects::kSyncPeriod, period});
}

}  // namespace

std::vector<PlannedWrite> in_allowed_order(std::vector<PlannedWrite> writes, const Values& present) {
  std::vector<PlannedWrite> out;
  hold_period(writes, out, present);
  for (const auto& write : writes)
    if (const auto now = present.find(write.object); now != present.end())
      if (auto data = cleared(write, now->second, writes)) out.push_back({write.object, std::move(*data)});
  out.insert(out.end(), writes.begin(), writes.end());
  return out;
}

}  // namespace servoctl::session
