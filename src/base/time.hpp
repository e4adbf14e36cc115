#pragma once

#include <chrono>

namespace servoctl {

/// Time on a bus: the steady clock for real transports, the bus's own for a simulated one.
using TimePoint = std::chrono::time_point<std::chrono::steady_clock, std::chrono::microseconds>;
using Duration = std::chrono::microseconds;

/// A deadline that never comes.
inline constexpr TimePoint kNever = TimePoint::max();

/// Now, on the clock of real transports.
inline TimePoint steady_now() {
  return std::chrono::time_point_cast<Duration>(std::chrono::steady_clock::now());
}

}  // namespace servoctl
