#pragma once

#include <cstdint>

#include "base/time.hpp"

namespace servoctl::sim {

/// The clock of a wire inside this process. With virtual time every wait ends at once and costs no real time;
/// with real time it is the clock of wires of hardware.
class SimClock {
 public:
  enum class Kind : std::uint8_t { virtual_time, real_time };

  explicit SimClock(Kind kind) : kind_(kind) {}

  TimePoint now() const;
  /// False when a signal came first.
  bool wait_until(TimePoint time);
  /// Virtual time goes on by itself; real time does not need it.
  void move_on(Duration time);

 private:
  Kind kind_;
  TimePoint virtual_now_{std::chrono::seconds(1)};
};

}  // namespace servoctl::sim
