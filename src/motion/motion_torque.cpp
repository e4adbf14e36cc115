#include <cmath>

#include "base/duration.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "drive/standard_objects.hpp"
#include "motion/motion_judgement.hpp"
#include "motion/motion_kinds.hpp"
#include "motion/motion_needs.hpp"
#include "session/stretch.hpp"

namespace servoctl::motion {
namespace {

/// A drive that limits its speed overshoots a little.
constexpr double kOvershoot = 1.2;

/// The drive's own limit of the speed, where the family has one that can be said in this unit.
Result<void> limit_speed(const Motion& motion, double cap, MotionPlan& plan) {
  const auto& units = motion.units();
  const auto unit = units.unit(objects::kTargetVelocity);
  for (const auto& name : motion.rules().speed_limit) {
    const auto object = units.object(name);
    if (!object || units.unit(*object) != unit) continue;
    const auto data = units.bytes(*object, cap);
    const auto held = data ? units.physical(*object, *data) : std::nullopt;
    if (!held) continue;
    if (held->value > cap * (1 + drive::kMostLoss)) {
      const auto numbers = told_apart(cap, held->value);
      return fail(Errc::usage,
                  message("--limit: {} {} cannot be set in the drive ({}): its nearest limit is {} {}",
                          numbers.first, unit, to_string(*object), numbers.second, held->unit),
                  "raise the limit");
    }
    plan.settings.emplace_back(*object, *data);
    if (*object == objects::kTargetVelocity) plan.kept_target = *object;
    if (units.meaning(*object).effect == od::Effect::restart)
      plan.tell(formatted(
          "the drive's speed limit in torque mode ({}) is set to {} {}, but may take effect only after a "
          "restart: servoctl monitors the speed and stops above {} {}",
          to_string(*object), number_text(held->value), held->unit, number_text(cap * kOvershoot), unit));
  }
  if (!plan.settings.empty()) return {};
  plan.tell(formatted(
      "the manual gives no speed limit of the drive in torque mode: servoctl checks the speed every {} ms "
      "and stops above {} {}",
      std::chrono::duration_cast<std::chrono::milliseconds>(MotionMonitor::kPeriod).count(),
      number_text(cap * kOvershoot), unit));
  return {};
}

void soften(const Motion& motion, double torque, MotionPlan& plan) {
  if (!motion.units().has(objects::kTorqueSlope) || motion.units().unit(objects::kTorqueSlope) != "%/s")
    return;
  (void)motion.add_setting(objects::kTorqueSlope, std::abs(torque) / Motion::kRampSeconds, plan);
}

Result<void> check_torque(const Motion& motion, const Physical& torque) {
  if (torque.value == 0)
    return fail(Errc::usage, "a torque of 0 has no effect", "give a torque other than 0");
  const auto cap = motion.torque_cap();
  if (!cap) return fail(cap.error());
  if (std::abs(torque.value) <= *cap * kUnitRounding) return {};
  const auto numbers = told_apart(std::abs(torque.value), *cap);
  return fail(
      motion.error(Errc::refused,
                   message("the torque of {} {} is above the limit of {} {}", numbers.first, torque.unit,
                           numbers.second, torque.unit),
                   message("`--max-torque {}{}` raises it, if machine and motor can take it, up to 6072h",
                           as_it_is(numbers.first), as_it_is(torque.unit))));
}

}  // namespace

Result<MotionPlan> plan_torque(Motion& motion, const Torque& torque) {
  const auto mode = mode_for(motion.session(), motion.units().profile(), motion.node(), drive::Use::torque);
  if (!mode) return fail(mode.error());
  if (const auto possible = motion.intend({drive::Use::torque}); !possible) return fail(possible.error());
  const auto cap = motion.speed_cap();
  if (!cap) return fail(cap.error());
  if (*cap <= 0) return fail(Errc::usage, "a speed limit of 0 lets nothing move", "give --limit a speed");
  const auto data = motion.units().parse(objects::kTargetTorque, torque.torque, MotionUnits::Kind::way);
  if (!data) return fail(data.error());
  const auto& value = data->value;
  if (const auto allowed = check_torque(motion, value); !allowed) return fail(allowed.error());
  MotionPlan plan;
  plan.mode = *mode;
  plan.command = data->data;
  plan.tell(data->rounding);
  plan.moving = {{objects::kTargetTorque, plan.command}};
  plan.value = value.value;
  plan.unit = value.unit;
  plan.speed = *cap;
  if (const auto limited = limit_speed(motion, *cap, plan); !limited) return fail(limited.error());
  soften(motion, value.value, plan);
  if (!motion.supervise_speed(*cap * kOvershoot))
    return fail(motion.error(
        Errc::refused,
        "has its speed (606Ch) in another unit than the limit (60FFh), so the limit cannot be monitored",
        motion.is_told_turn()
            ? ""
            : "add --turn (6064h increments per revolution), if the drive does not report it"));
  motion.set_standstill(*cap);
  plan.summary = formatted("apply a torque of {} {} for {}, no faster than {} {}", number_text(value.value),
                           value.unit, servoctl::to_string(torque.length), number_text(*cap),
                           motion.units().unit(objects::kTargetVelocity));
  return plan;
}

MotionReport run_torque(Motion& motion, const Torque& torque, const MotionPlan& plan) {
  auto done = motion.begin(plan.mode, plan.settings, plan.kept_target);
  const auto began_at = motion.session().now();
  if (done) done = motion.write(objects::kTargetTorque, plan.command);
  MotionJudgement judgement;
  if (done) {
    const auto told_at = motion.session().now();
    const session::Stretch stretch(motion.session(), told_at + torque.length);
    const auto watched =
        motion.watch([](const MotionSample&) -> Result<bool> { return false; }, torque.length);
    if (!watched) done = fail(watched.error());
    judgement.judge_torque(motion, plan, told_at, motion.session().now());
    judgement.judge_time(torque.length, began_at, motion.session().now());
  }
  return judgement.into(motion.finish(std::move(done)));
}

}  // namespace servoctl::motion
