#pragma once

#include <optional>

#include "base/time.hpp"

namespace servoctl::can {

/// Times of our own clock from the stamps of another: an adapter's, or a server's. Between stamp and arrival
/// lies a delay that is never less than the smallest one; so far the stamps are taken for late. Frames that
/// came in one piece have their distances so. Where all are late for a second, the other clock was set back.
class ForeignClock {
 public:
  /// Stamps begin anew after `period`; zero: they never do.
  explicit ForeignClock(Duration period = Duration::zero()) : period_(period) {}

  /// When the frame was stamped that was read at `now`; never later than that, never before the last one.
  TimePoint time(Duration stamp, TimePoint now);
  void reset() { *this = ForeignClock(period_); }

 private:
  void follow(Duration late, TimePoint now);

  Duration period_;
  std::optional<Duration> offset_;  ///< From the stamps to our clock.
  Duration unwrapped_{};            ///< The last stamp, periods counted.
  TimePoint read_{};                ///< When that was.
  TimePoint last_{};
  Duration least_late_ = Duration::max();  ///< In this window.
  TimePoint window_end_{};
};

}  // namespace servoctl::can
