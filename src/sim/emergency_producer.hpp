#pragma once

#include <deque>
#include <optional>

#include "base/time.hpp"
#include "can/frame.hpp"

namespace servoctl::sim {

/// Emergencies of a drive on their way to the bus: in their order, one in each inhibit time (1015h; CiA 301,
/// 7.5.2.18). Performs no I/O and reads no clock.
class EmergencyProducer {
 public:
  void push(const can::Frame& frame) { waiting_.push_back(frame); }
  /// What is left will not be sent.
  void clear() { waiting_.clear(); }
  /// The next one, when it may be sent.
  std::optional<can::Frame> take_frame(Duration inhibit, TimePoint now) {
    if (waiting_.empty() || now < deadline(inhibit)) return std::nullopt;
    const auto frame = waiting_.front();
    waiting_.pop_front();
    sent_ = now;
    return frame;
  }
  TimePoint deadline(Duration inhibit) const {
    if (waiting_.empty()) return kNever;
    return sent_ ? *sent_ + inhibit : TimePoint::min();
  }

 private:
  std::deque<can::Frame> waiting_;
  std::optional<TimePoint> sent_;
};

}  // namespace servoctl::sim
