#include "sim/heartbeat_consumer.hpp"

#include <algorithm>

#include "canopen/cob_id.hpp"

namespace servoctl::sim {

void HeartbeatConsumer::set(std::uint8_t entry, std::uint32_t value) {
  if (entry < 1 || entry > kMost) return;
  entries_[entry - 1U] = {static_cast<std::uint8_t>(value >> 16U & 0x7FU),
                          std::chrono::milliseconds(value & 0xFFFFU), kNever};
}

void HeartbeatConsumer::on_frame(const can::Frame& frame, TimePoint now) {
  if (frame.extended || frame.remote || frame.error) return;
  for (auto& entry : entries_)
    if (entry.node != 0 && entry.time > Duration::zero() && frame.id == canopen::kErrorControl + entry.node)
      entry.ends = now + entry.time;
}

bool HeartbeatConsumer::take_lost(TimePoint now) {
  bool lost = false;
  for (auto& entry : entries_) {
    if (now < entry.ends) continue;
    entry.ends = kNever;
    lost = true;
  }
  return lost;
}

TimePoint HeartbeatConsumer::deadline() const {
  return std::min_element(entries_.begin(), entries_.end(),
                          [](const Entry& a, const Entry& b) { return a.ends < b.ends; })
      ->ends;
}

}  // namespace servoctl::sim
