#include <fmt/format.h>
#include <cmath>

#include "base/duration.hpp"
#include "drive/standard_objects.hpp"
#include "session/motion_kinds.hpp"

namespace servoctl::session {
namespace {

/// A drive that limits its speed overshoots a little.
constexpr double kOvershoot = 1.2;

/// The drive's own limit of the speed, where the family has one that can be said in this unit.
void limit_speed(const Motion& motion, double cap, MotionPlan& plan) {
  for (const auto& name : motion.rules().speed_limit) {
    const auto object = motion.units().object(name);
    if (!object || motion.units().unit(*object) != motion.units().unit(objects::kTargetVelocity)) continue;
    const auto data = motion.units().bytes(*object, cap);
    if (!data) continue;
    plan.settings.emplace_back(*object, *data);
    if (*object == objects::kTargetVelocity) plan.kept_target = *object;
  }
  if (plan.settings.empty())
    plan.notes.push_back(fmt::format(
        "the drive has no speed limit of its own in torque mode that the manual tells: servoctl looks at the "
        "speed every {} ms and stops above {:g} {}",
        std::chrono::duration_cast<std::chrono::milliseconds>(MotionMonitor::kPeriod).count(),
        cap * kOvershoot, motion.units().unit(objects::kTargetVelocity)));
}

void soften(const Motion& motion, double torque, MotionPlan& plan) {
  if (!motion.units().has(objects::kTorqueSlope) || motion.units().unit(objects::kTorqueSlope) != "%/s")
    return;
  if (const auto data = motion.units().bytes(objects::kTorqueSlope, std::abs(torque) / Motion::kRampSeconds))
    plan.settings.emplace_back(objects::kTorqueSlope, *data);
}

}  // namespace

Result<MotionPlan> plan_torque(Motion& motion, const Torque& torque) {
  const auto mode = motion.rules().torque;
  if (!mode) return fail(motion.error(Errc::refused, "this family has no torque mode"));
  const auto cap = motion.speed_cap();
  if (!cap) return tl::unexpected<Error>(cap.error());
  if (*cap <= 0) return fail(Errc::usage, "a speed limit of 0 lets nothing move", "give --limit a speed");
  const auto data = motion.units().parse(objects::kTargetTorque, torque.torque);
  if (!data) return tl::unexpected<Error>(data.error());
  const auto value = motion.units().physical(objects::kTargetTorque, *data).value_or(Physical{});
  if (value.value == 0) return fail(Errc::usage, "a torque of 0 does nothing", "say how much");
  MotionPlan plan;
  plan.mode = *mode;
  plan.command = *data;
  plan.value = value.value;
  plan.unit = value.unit;
  plan.speed = *cap;
  limit_speed(motion, *cap, plan);
  soften(motion, value.value, plan);
  if (!motion.supervise_speed(*cap * kOvershoot))
    return fail(motion.error(Errc::refused,
                             "tells its speed in another unit than its limit: nobody would watch it",
                             "add --turn COUNTS, if the drive does not tell its encoder"));
  motion.set_standstill(*cap);
  plan.summary =
      fmt::format("push with {:g} {} for {}, no faster than {:g} {}", value.value, value.unit,
                  servoctl::to_string(torque.length), *cap, motion.units().unit(objects::kTargetVelocity));
  return plan;
}

MotionReport run_torque(Motion& motion, const Torque& torque, const MotionPlan& plan) {
  auto done = motion.begin(plan.mode, plan.settings, plan.kept_target);
  if (done) done = motion.write(objects::kTargetTorque, plan.command);
  if (done) {
    const auto watched =
        motion.watch([](const MotionSample&) -> Result<bool> { return false; }, torque.length);
    if (!watched) done = tl::unexpected<Error>(watched.error());
  }
  return motion.finish(std::move(done));
}

}  // namespace servoctl::session
