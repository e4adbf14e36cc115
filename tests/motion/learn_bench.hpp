#pragma once

#include <cmath>

#include "motion_support.hpp"
#include "session/can_network.hpp"
#include "session/measure.hpp"

namespace servoctl::motion {

inline constexpr ObjectAddress kMonitor{0x2005, 3};
inline constexpr ObjectAddress kMode{0x2002, 0x39};  // Pn0456

class LearnBench : public MotionBench {
 public:
  explicit LearnBench(double counts) : MotionBench("gsd600") { drive().own_counts() = counts; }

  LearnReport learn() {
    const session::MeasureQuestion question[] = {{1, drive::Measure::increments_per_turn, 1.0}};
    const auto gear = session::read_measures(*session, profile(), question).front();
    LearnReport out;
    if (!gear || !gear->learned) {
      out.motion.outcome = fail(Errc::refused, "nothing to measure");
      return out;
    }
    how.monitor = kMonitor;
    how.monitor_name = "Pn1002";
    how.least = profile().rules.learn.least;
    how.gear = gear->value;
    Motion motion(*session, profile(), 1, options);
    auto ready = motion.prepare();
    const auto plan = plan_learn(motion, how);
    if (!plan) ready = fail(plan.error());
    if (!ready) {
      out.motion.outcome = ready;
      return out;
    }
    before = objects();
    return run_learn(motion, how, *plan);
  }

  /// The monitor says what `lie` makes of its tenths of a rpm.
  void lie(std::function<double(double)> lie) {
    bus->alter = [lie = std::move(lie)](can::Frame& frame) {
      constexpr std::uint8_t kAnswer[] = {0x43, 0x05, 0x20, 0x03};
      if (frame.id != 0x581 || !std::equal(std::begin(kAnswer), std::end(kAnswer), frame.data.begin()))
        return;
      const auto bytes = std::span(frame.data).subspan(4, 4);
      const auto raw = static_cast<std::int32_t>(load_le(bytes));
      const auto told = store_le(static_cast<std::uint32_t>(std::lround(lie(raw))), 4);
      std::copy(told.begin(), told.end(), bytes.begin());
    };
  }

  /// The greatest speed that was written to 60FFh, in increments a second.
  double fastest() const {
    double out = 0;
    for (const auto& text : bus->frames)
      if (text.starts_with("601#23FF6000"))
        out = std::max(out, std::abs(static_cast<double>(static_cast<std::int32_t>(
                                load_le(can::parse_frame(text)->payload().subspan(4, 4))))));
    return out;
  }

  Learn how;
};

}  // namespace servoctl::motion
