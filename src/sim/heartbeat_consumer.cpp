#include "sim/heartbeat_consumer.hpp"

#include <algorithm>
#include <utility>

#include "canopen/cob_id.hpp"
#include "canopen/error_control.hpp"

namespace servoctl::sim {

void HeartbeatConsumer::set(std::uint8_t entry, std::uint32_t value) {
  if (entry < 1 || entry > kMost) return;
  entries_[entry - 1U] = {canopen::watched_node(value), std::chrono::milliseconds(value & 0xFFFFU)};
}

void HeartbeatConsumer::on_frame(const can::Frame& frame, TimePoint now) {
  if (frame.extended || frame.remote || frame.error) return;
  for (auto& entry : entries_) {
    if (entry.node == 0 || frame.id != canopen::kErrorControl + entry.node) continue;
    entry.ends = now + entry.time;
    found_ = found_ || entry.lost;
    entry.lost = false;
  }
}

bool HeartbeatConsumer::take_lost(TimePoint now) {
  bool lost = false;
  for (auto& entry : entries_) {
    if (now < entry.ends) continue;
    entry.ends = kNever;
    entry.lost = lost = true;
  }
  return lost;
}

bool HeartbeatConsumer::take_found() {
  const bool silent = std::any_of(entries_.begin(), entries_.end(), [](const Entry& e) { return e.lost; });
  return std::exchange(found_, false) && !silent;
}

TimePoint HeartbeatConsumer::deadline() const {
  return std::min_element(entries_.begin(), entries_.end(),
                          [](const Entry& a, const Entry& b) { return a.ends < b.ends; })
      ->ends;
}

}  // namespace servoctl::sim
