#pragma once

#include <ctime>

#include "base/time.hpp"

namespace servoctl {

/// For ppoll() and its like; `time` is not negative.
inline timespec to_timespec(Duration time) {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(time);
  timespec out{};
  out.tv_sec = seconds.count();
  out.tv_nsec = std::chrono::nanoseconds(time - seconds).count();
  return out;
}

}  // namespace servoctl
