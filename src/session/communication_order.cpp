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

/// The period is 0 while the counter changes, and gets its value behind it. `now`: what it is; empty where
/// that is not known.
void hold_period(std::vector<PlannedWrite>& writes, std::vector<PlannedWrite>& first,
                 const std::optional<Bytes>& now) {
  const auto at = [&](ObjectAddress object) {
    return std::find_if(writes.begin(), writes.end(), [&](const auto& w) { return w.object == object; });
  };
  const auto planned = at(objects::kSyncPeriod);
  if (at(objects::kSyncOverflow) == writes.end() || (!now && planned == writes.end())) return;
  const auto period = planned != writes.end() ? planned->data : *now;
  if (planned != writes.end()) writes.erase(planned);
  if (!now || number(*now) != 0) first.push_back({objects::kSyncPeriod, Bytes(period.size(), 0)});
  if (number(period) != 0) writes.insert(at(objects::kSyncOverflow) + 1, {objects::kSyncPeriod, period});
}

/// No entry of 1016h watches anybody before the first is written.
void clear_consumers(std::vector<PlannedWrite>& writes, std::vector<PlannedWrite>& first) {
  const auto watches = [](const PlannedWrite& write) {
    return is_consumer(write.object) && canopen::watched_node(number(write.data)) != 0;
  };
  if (std::none_of(writes.begin(), writes.end(), watches)) return;
  for (const auto& write : writes)
    if (is_consumer(write.object)) first.push_back({write.object, Bytes(write.data.size(), 0)});
  std::erase_if(writes, [](const auto& w) { return is_consumer(w.object) && number(w.data) == 0; });
}

}  // namespace

std::vector<PlannedWrite> in_allowed_order(std::vector<PlannedWrite> writes, const Values& present) {
  std::vector<PlannedWrite> out;
  const auto period = present.find(objects::kSyncPeriod);
  if (period != present.end()) hold_period(writes, out, period->second);
  for (const auto& write : writes)
    if (const auto now = present.find(write.object); now != present.end())
      if (auto data = cleared(write, now->second, writes)) out.push_back({write.object, std::move(*data)});
  out.insert(out.end(), writes.begin(), writes.end());
  return out;
}

bool is_written_in_steps(ObjectAddress object) {
  return is_consumer(object) || object == objects::kSyncCobId || object == objects::kSyncPeriod ||
         object == objects::kTimeCobId || object == objects::kEmergencyCobId;
}

std::vector<PlannedWrite> in_order_for_any_drive(std::vector<PlannedWrite> writes) {
  std::vector<PlannedWrite> out;
  hold_period(writes, out, std::nullopt);
  clear_consumers(writes, out);
  for (const auto& write : writes)
    if (const auto off = switched_off(write.object, number(write.data)))
      out.push_back({write.object, store_le(*off, write.data.size())});
  out.insert(out.end(), writes.begin(), writes.end());
  return out;
}

}  // namespace servoctl::session
