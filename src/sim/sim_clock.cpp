#include "sim/sim_clock.hpp"

#include <algorithm>

#include "base/signal_wait.hpp"
#include "base/timespec.hpp"

namespace servoctl::sim {

TimePoint SimClock::now() const { return kind_ == Kind::real_time ? steady_now() : virtual_now_; }

bool SimClock::wait_until(TimePoint time) {
  if (kind_ == Kind::virtual_time) {
    virtual_now_ = std::max(virtual_now_, time);
    return true;
  }
  const auto left = left_until(time);
  if (left <= Duration::zero()) return true;
  return wait_or_signal({}, std::min<Duration>(left, std::chrono::hours(1))) == 0;
}

void SimClock::move_on(Duration time) { virtual_now_ += time; }

}  // namespace servoctl::sim
