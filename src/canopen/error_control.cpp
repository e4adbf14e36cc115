#include "canopen/error_control.hpp"

#include <algorithm>
#include <utility>

#include "canopen/cob_id.hpp"

namespace servoctl::canopen {

std::uint8_t watched_node(std::uint32_t consumer_entry) {
  const auto node = consumer_entry >> 16U & 0xFFU;
  const bool on = (consumer_entry & 0xFFFFU) != 0 && node <= kLastNode;
  return on ? static_cast<std::uint8_t>(node) : std::uint8_t{0};
}

void ErrorControlSlave::boot(NmtState state, TimePoint now) {
  tx_ = heartbeat_frame(node_, NmtState::initialising);
  state_ = state;
  toggle_ = 0;
  life_ends_ = kNever;
  life_lost_ = false;
  set_heartbeat(heartbeat_, now);
}

void ErrorControlSlave::stop() {
  state_ = NmtState::initialising;
  next_heartbeat_ = kNever;
  life_ends_ = kNever;
}

void ErrorControlSlave::set_heartbeat(Duration period, TimePoint now) {
  heartbeat_ = period;
  next_heartbeat_ = period == Duration::zero() || state_ == NmtState::initialising ? kNever : now + period;
}

void ErrorControlSlave::set_life_time(Duration guard_time, std::uint32_t factor) {
  life_time_ = guard_time * factor;
  if (life_time_ == Duration::zero()) life_ends_ = kNever;
}

void ErrorControlSlave::on_frame(const can::Frame& frame, TimePoint now) {
  const bool asked = frame.remote && !frame.extended && !frame.error && frame.id == kErrorControl + node_;
  if (!asked || state_ == NmtState::initialising || heartbeat_ != Duration::zero()) return;
  auto answer = heartbeat_frame(node_, state_);
  answer.data[0] = static_cast<std::uint8_t>(answer.data[0] | std::exchange(toggle_, toggle_ ^ 0x80U));
  tx_ = answer;
  if (life_time_ != Duration::zero()) life_ends_ = now + life_time_;
}

void ErrorControlSlave::on_time(TimePoint now) {
  if (now >= next_heartbeat_) {
    tx_ = heartbeat_frame(node_, state_);
    next_heartbeat_ = now + heartbeat_;
  }
  if (now >= life_ends_) {
    life_lost_ = true;
    life_ends_ = kNever;
  }
}

std::optional<can::Frame> ErrorControlSlave::take_frame() { return std::exchange(tx_, std::nullopt); }

TimePoint ErrorControlSlave::deadline() const { return std::min(next_heartbeat_, life_ends_); }

bool ErrorControlSlave::take_life_lost() { return std::exchange(life_lost_, false); }

}  // namespace servoctl::canopen
