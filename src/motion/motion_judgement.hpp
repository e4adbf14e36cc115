#pragma once

#include <string>
#include <vector>

#include "motion/motion_kinds.hpp"

namespace servoctl::motion {

/// Whether what was measured of a motion is what was asked for. A motion that came to its end is not one that
/// did what it was told.
struct MotionJudgement {
  std::vector<std::string> differences;
  std::vector<std::string> unchecked;

  /// The speed at the end of a jog, once its ramp is over: within a tenth of what was asked.
  void judge_speed(const Motion& motion, const MotionPlan& plan, TimePoint told_at, TimePoint stopped_at);
  /// The time of a motion of a given length, and the way of a jog in it: between half of what it goes with
  /// its ramps and a tenth more than without, and what it goes in 0.3 s. Where no ramp was set that it must
  /// not have moved at all. `told_at`: before it was told to go, `stopped_at`: after it was told to stop.
  void judge_time(Duration asked, TimePoint told_at, TimePoint stopped_at);
  void judge_way_in_time(const Motion& motion, const MotionPlan& plan, Duration asked);
  /// The way of a jog by turns: within a twentieth, and what it goes between two looks.
  void judge_way(const Motion& motion, const MotionPlan& plan);
  /// Where a move ended, which 6067h may allow to be far away.
  void judge_target(const Motion& motion, const MotionPlan& plan, double near);
  /// The torque at the end: within a fifth of what was asked, unless the speed limit held it back.
  void judge_torque(const Motion& motion, const MotionPlan& plan, TimePoint told_at, TimePoint stopped_at);

  MotionReport into(MotionReport report) const;
};

}  // namespace servoctl::motion
