#include "motion/motion_judgement.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

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
  differences.push_back(fmt::format("the speed was {} {}; {} {} was commanded", number_text(speed), plan.unit,
                                    number_text(plan.value), plan.unit));
}

void MotionJudgement::judge_way(const Motion& motion, const MotionPlan& plan) {
  const auto& samples = motion.monitor().samples();
  std::vector<double> places;
  for (const auto& sample : samples)
    if (const auto place = sample[Signal::position]) places.push_back(*place);
  if (places.empty()) return;
  double step = 0;
  for (std::size_t i = 1; i < places.size(); ++i) step = std::max(step, std::abs(places[i] - places[i - 1]));
  const double way = places.back() - places.front();
  const double asked = std::copysign(plan.way, plan.value);
  if (std::abs(way - asked) <= plan.way * kWayTolerance + 2 * step) return;
  const auto unit = motion.units().unit(objects::kPositionActual);
  differences.push_back(
      fmt::format("it moved {} {}; {} {} was commanded", number_text(way), unit, number_text(asked), unit));
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
      fmt::format("it is at {} {}; {} {} was commanded (the position window, 6067h, is wider)", numbers.first,
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
  const auto text = fmt::format("the torque was {} {}; {} {} was commanded", number_text(torque), plan.unit,
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
