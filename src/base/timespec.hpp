#pragma once

#include <ctime>

#include "base/time.hpp"

namespace servoctl {

/// How long it is from `now` to `deadline`; zero when that is over, whatever the two are: what is due at once
/// may have TimePoint::min(), from which nothing can be subtracted.
constexpr Duration left_between(TimePoint now, TimePoint deadline) {
  return deadline > now ? deadline - now : Duration::zero();
}
/// On the clock of real transports.
inline Duration left_until(TimePoint deadline) { return left_between(steady_now(), deadline); }

/// For ppoll() and its like; `time` is not negative.
inline timespec to_timespec(Duration time) {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(time);
  timespec out{};
  out.tv_sec = seconds.count();
  out.tv_nsec = std::chrono::nanoseconds(time - seconds).count();
  return out;
}

}  // namespace servoctl
