#pragma once

#include <cmath>
#include <string>

#include "sim_support.hpp"

namespace servoctl::sim {

using namespace std::chrono_literals;

inline constexpr unsigned kAttained = 1U << 12U;

inline constexpr double kTurn = 10000;  // Increments and pulses in one turn.

/// What a run was seen to do.
struct Homed {
  unsigned statusword = 0;
  double home = 0;         ///< In turns from where the axis stood at first.
  double rest = 0;         ///< 6064h at its end.
  int first = 0;           ///< Direction in which it began.
  int last = 0;            ///< Direction in which it came to its end.
  double fastest_end = 0;  ///< Turns a second when it came there.
};

class HomingTest : public DrivenTest {
 protected:
  void SetUp() override { start("cia402"); }

  void start(const std::string& family) {
    boot(family);
    write({0x608F, 1}, "10000");
    write({0x6092, 1}, "10000");
    write({0x6099, 1}, "100000");
    write({0x6099, 2}, "10000");
    write({0x609A, 0}, "1000000");
    drive().track() = {.negative_limit = {-Track::kFar, -2, {}},
                       .positive_limit = {6, Track::kFar, {}},
                       .home = {1, 3.5, {}}};
  }
  /// The axis stands here at first.
  void stand_at(double place) {
    auto& track = drive().track();
    for (auto* one : {&track.negative_limit, &track.positive_limit, &track.home}) {
      one->from -= place;
      one->to -= place;
    }
    track.index -= place;
    from_ = place;
  }
  Homed home(int method, Duration longest = 20s) {
    write({0x6098, 0}, std::to_string(method));
    write({0x6040, 0}, "15");
    write({0x6040, 0}, "31");
    Homed run;
    const auto end = bus.now() + longest;
    while (bus.now() < end) {
      run.statusword = status();
      const double speed = read({0x606C, 0}) / kTurn;
      const int sign = speed > 0 ? 1 : speed < 0 ? -1 : 0;
      if (run.first == 0) run.first = sign;
      if ((run.statusword & (kAttained | kError)) != 0) break;
      if (sign != 0) run.last = sign;
      if (sign != 0) run.fastest_end = std::abs(speed);
      (void)next(1ms);
    }
    run.rest = read({0x6064, 0});
    run.home = from_ + (read({0x6063, 0}) - read({0x6064, 0})) / kTurn;
    return run;
  }

  double from_ = 0;
};

}  // namespace servoctl::sim
