#pragma once

#include <ctime>

#include "base/time.hpp"

namespace servoctl {

/// On the clock of real transports; none when it is over.
inline Duration left_until(TimePoint deadline) {
  const auto now = steady_now();
  return deadline > now ? deadline - now : Duration::zero();
}

/// For ppoll() and its like; `time` is not negative.
inline timespec to_timespec(Duration time) {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(time);
  timespec out{};
  out.tv_sec = seconds.count();
  out.tv_nsec = std::chrono::nanoseconds(time - seconds).count();
  return out;
}

}  // namespace servoctl
