#include "motion/motion_judgement.hpp"

#include <algorithm>
#include <cmath>

#include "base/format.hpp"
#include "base/number.hpp"

namespace servoctl::motion {
namespace {

constexpr double kSpeedTolerance = 0.1;
constexpr double kWayTolerance = 0.05;
constexpr double kTorqueTolerance = 0.2;
/// Of the torque's own unit; what sensors of the current show at rest.
constexpr double kTorqueNoise = 1;
constexpr double kTorqueNoiseNm = 0.02;
/// Nearer than this to its limit the speed is limited.
constexpr double kAtLimit = 0.9;
/// Of ramps that servoctl chose, with what a drive may add to them.
constexpr Duration kRamp = std::chrono::milliseconds(750);
/// The end of a motion, which is looked at; and so many samples are needed for it.
constexpr Duration kEnd = std::chrono::milliseconds(300);
constexpr std::size_t kSamples = 2;
/// A ramp of unknown length is over when the speed changes by no more than this part of it.
constexpr double kSteady = 0.03;

/// A motion may take so much longer than it was to take, and go so much farther.
constexpr double kTimeTolerance = 0.1;
constexpr double kTimeSlack = 0.3;  ///< Seconds.
constexpr double kLeastPart = 0.5;

double in_seconds(Duration time) { return std::chrono::duration<double>(time).count(); }

/// The values of a signal at the end of the time in which the motor was told to move.
std::vector<double> values_at_end(const std::vector<MotionSample>& samples, Signal signal, TimePoint told_at,
                                  TimePoint stopped_at) {
  std::vector<double> out;
  const auto since = std::max(told_at + kRamp, stopped_at - kEnd);
  for (const auto& sample : samples)
    if (sample.time >= since && sample.time <= stopped_at && sample[signal]) out.push_back(*sample[signal]);
  return out;
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const auto value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

double spread(const std::vector<double>& values) {
  const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
  return *greatest - *least;
}

bool tells(const std::vector<MotionSample>& samples, Signal signal) {
  return std::any_of(samples.begin(), samples.end(), [&](const auto& s) { return s[signal].has_value(); });
}

}  // namespace

void MotionJudgement::judge_speed(const Motion& motion, const MotionPlan& plan, TimePoint told_at,
                                  TimePoint stopped_at) {
  const auto& samples = motion.monitor().samples();
  const bool same_unit =
      motion.units().unit(objects::kVelocityActual) == motion.units().unit(objects::kTargetVelocity);
  if (!tells(samples, Signal::velocity) || !same_unit) {
    unchecked.push_back("the speed was not checked: the drive does not report it in the unit of the target");
    return;
  }
  const auto values = values_at_end(samples, Signal::velocity, told_at, stopped_at);
  const bool speeding_up =
      motion.has_own_ramps() && values.size() >= kSamples && spread(values) > std::abs(plan.value) * kSteady;
  if (values.size() < kSamples || speeding_up) {
    unchecked.push_back("the speed was not checked: the motion ended during its ramp");
    return;
  }
  const double speed = mean(values);
  if (std::abs(speed - plan.value) <= std::abs(plan.value) * kSpeedTolerance + motion.standstill()) return;
  differences.push_back(formatted("the speed was {} {}; {} {} was commanded", number_text(speed), plan.unit,
                                  number_text(plan.value), plan.unit));
}

void MotionJudgement::judge_time(Duration asked, TimePoint told_at, TimePoint stopped_at) {
  const double took = in_seconds(stopped_at - told_at);
  const double wanted = in_seconds(asked);
  if (took <= wanted * (1 + kTimeTolerance) + kTimeSlack) return;
  differences.push_back(
      formatted("it took {} s; {} s were commanded", number_text(took), number_text(wanted)));
}

void MotionJudgement::judge_way_in_time(const Motion& motion, const MotionPlan& plan, Duration asked) {
  const auto way = motion.monitor().way();
  if (!way) {
    unchecked.push_back("the way was not checked: the drive does not report its position");
    return;
  }
  const auto unit = motion.units().unit(objects::kPositionActual);
  const auto rate = motion.units().rate(objects::kTargetVelocity);
  if (!rate) {
    if (*way == 0) differences.push_back("its position (6064h) did not change");
    return;
  }
  const double speed = plan.value * *rate;
  const double seconds = in_seconds(asked);
  const bool ramp_known =
      !motion.has_own_ramps() &&
      std::any_of(plan.settings.begin(), plan.settings.end(),
                  [](const MotionSetting& one) { return one.first == objects::kProfileAcceleration; });
  const double part = ramp_known ? kLeastPart * std::min(1.0, seconds / Motion::kRampSeconds) : 0;
  const double least = std::abs(speed) * seconds * part;
  const double most = std::abs(speed) * (seconds * (1 + kTimeTolerance) + kTimeSlack);
  const double gone = *way * (speed < 0 ? -1 : 1);
  if (gone > 0 && gone >= least && gone <= most) return;
  differences.push_back(formatted("it moved {} {} in {} s; about {} {} were commanded", number_text(*way),
                                  unit, number_text(seconds), number_text(speed * seconds), unit));
}

void MotionJudgement::judge_way(const Motion& motion, const MotionPlan& plan) {
  const auto way = motion.monitor().way();
  if (!way) return;
  const auto& samples = motion.monitor().samples();
  double step = 0;
  for (std::size_t i = 1; i < samples.size(); ++i)
    if (samples[i][Signal::position] && samples[i - 1][Signal::position])
      step = std::max(step, std::abs(*samples[i][Signal::position] - *samples[i - 1][Signal::position]));
  const double asked = std::copysign(plan.way, plan.value);
  if (std::abs(*way - asked) <= plan.way * kWayTolerance + 2 * step) return;
  const auto unit = motion.units().unit(objects::kPositionActual);
  differences.push_back(
      formatted("it moved {} {}; {} {} was commanded", number_text(*way), unit, number_text(asked), unit));
}

void MotionJudgement::judge_target(const Motion& motion, const MotionPlan& plan, double near) {
  const auto& samples = motion.monitor().samples();
  const auto place = samples.empty() ? std::nullopt : samples.back()[Signal::position];
  if (!place) {
    unchecked.push_back("the position was not checked: the drive does not report it");
    return;
  }
  if (std::abs(*place - plan.value) <= near) return;
  const auto numbers = told_apart(*place, plan.value);
  differences.push_back(
      formatted("it is at {} {}; {} {} was commanded (the position window, 6067h, is wider)", numbers.first,
                plan.unit, numbers.second, plan.unit));
}

void MotionJudgement::judge_torque(const Motion& motion, const MotionPlan& plan, TimePoint told_at,
                                   TimePoint stopped_at) {
  const auto& samples = motion.monitor().samples();
  const auto values = values_at_end(samples, Signal::torque, told_at, stopped_at);
  const auto speeds = values_at_end(samples, Signal::velocity, told_at, stopped_at);
  const bool same_unit = motion.units().unit(objects::kTorqueActual) == plan.unit;
  if (!tells(samples, Signal::torque) || !same_unit) {
    unchecked.push_back("the torque was not checked: the drive does not report it in the unit of the target");
    return;
  }
  if (values.size() < kSamples) {
    unchecked.push_back("the torque was not checked: the motion ended during its slope");
    return;
  }
  const double torque = mean(values);
  const double noise = plan.unit == "Nm" ? kTorqueNoiseNm : kTorqueNoise;
  if (std::abs(torque - plan.value) <= std::abs(plan.value) * kTorqueTolerance + noise) return;
  const auto text = formatted("the torque was {} {}; {} {} was commanded", number_text(torque), plan.unit,
                              number_text(plan.value), plan.unit);
  if (!speeds.empty() && std::abs(mean(speeds)) >= plan.speed * kAtLimit)
    unchecked.push_back(text + ": limited by the speed limit");
  else
    differences.push_back(text);
}

MotionReport MotionJudgement::into(MotionReport report) const {
  if (!report.outcome) return report;
  report.differences = differences;
  report.unchecked.insert(report.unchecked.end(), unchecked.begin(), unchecked.end());
  return report;
}

}  // namespace servoctl::motion
