// What a motion must not exceed: by its user, by the drive, and because it is safe.
#include <algorithm>
#include <cmath>

#include "base/format.hpp"
#include "base/number.hpp"
#include "drive/naming.hpp"
#include "drive/standard_objects.hpp"
#include "motion/kept_turn.hpp"
#include "motion/motion.hpp"
#include "session/option_scope.hpp"

namespace servoctl::motion {
namespace {

/// From so many rpm on, the monitor of the speed and 606Ch must not differ by more than this factor.
constexpr double kComparedRpm = 10;
constexpr double kMostContradiction = 1.5;
constexpr int kOddLooks = 2;
/// A motor turns too fast that the monitor shows so much faster than it was told to turn.
constexpr double kTooFastFactor = 1.5;
constexpr double kTooFastRpm = 60;
/// No servo motor turns faster.
constexpr double kMostRpm = 100'000;
/// A torque in per cent is one of the rated torque.
constexpr double kRatedTorque = 100;

/// Give or take what a monitor that is read a moment later shows.
bool is_a_ten(double factor) { return factor > 8 && factor < 12.5; }

}  // namespace

Result<void> Motion::read_limits() {
  struct Row {
    Signal signal;
    std::string_view option;
    const std::string* text;
    std::optional<double>* out;
  };
  auto& limits = monitor_->limits();
  for (const auto& row : {Row{Signal::torque, "--max-torque", &options_.max_torque, &limits.torque},
                          Row{Signal::following_error, "--max-following-error", &options_.max_following_error,
                              &limits.following_error},
                          Row{Signal::position, "--window", &options_.window, &limits.travel}}) {
    if (row.text->empty()) continue;
    const auto object = object_of(row.signal);
    // Of a torque that is asked for it is the ceiling as well; other motions are refused by check_speed().
    if (row.signal == Signal::torque && !units_->has(object) && rules().torque) continue;
    if (!units_->has(object))
      return fail(
          Errc::usage,
          message("this family does not report its {} ({})", name(row.signal), as_it_is(to_string(object))),
          "leave this limit out");
    const auto value = parse_limit(object, row.option, *row.text);
    if (!value) return fail(value.error());
    *row.out = *value;
  }
  if (options_.acceleration.empty()) return {};
  const auto ramp =
      units_->parse(objects::kProfileAcceleration, options_.acceleration, MotionUnits::Kind::size);
  if (!ramp) return fail(ramp.error());
  if (ramp->value.value > 0) return {};
  return fail(Errc::usage, message("--accel: '{}' is not a ramp", as_it_is(options_.acceleration)),
              "a ramp must be above 0, without a sign");
}

Result<double> Motion::parse_limit(ObjectAddress object, std::string_view option,
                                   const std::string& text) const {
  const auto value = units_->parse_physical(object, text, MotionUnits::Kind::size);
  if (!value) {
    auto error = value.error();
    error.message = message("{}: {}", option, error.message);
    return fail(std::move(error));
  }
  if (object == objects::kTargetVelocity && value->unit == "rpm" && value->value > kMostRpm)
    return fail(Errc::usage, message("{}: '{}' is more than any motor turns", option, as_it_is(text)),
                message("the greatest limit is {} rpm", number_text(kMostRpm)));
  if (value->value > 0) return value->value;
  return fail(Errc::usage, message("{}: '{}' is not a limit", option, as_it_is(text)),
              "a limit must be above 0, without a sign");
}

Result<std::optional<double>> Motion::read_as(ObjectAddress as, ObjectAddress object) const {
  if (!units_->has(object) || units_->unit(object) != units_->unit(as)) return std::optional<double>();
  const auto answer = session_->upload(node_, object);
  if (!answer && answer.error().code != Errc::sdo_abort) return fail(answer.error());
  const auto value = answer ? units_->physical(object, *answer) : std::nullopt;
  return value && value->value > 0 ? std::optional(value->value) : std::nullopt;
}

/// What the drive's own monitor of the speed shows, in rpm; empty where it has none, or refuses to give it.
Result<std::optional<double>> Motion::monitored_speed() {
  const auto& name = profile_->rules.learn.speed;
  const auto monitor = units_->object(name);
  if (!monitor || !turn_unchecked_.empty()) return std::optional<double>();
  const session::Hurry hurry(*session_, kMovingPatience, 1);
  const auto answer = session_->upload(node_, *monitor);
  // Kept counts were measured by this monitor; what the drive's own parameters tell holds without it.
  if (!answer && answer.error().code == Errc::sdo_abort && !units_->uses_learned()) {
    turn_unchecked_ =
        formatted("its counts per revolution were not compared with {}, which it refuses to give", name);
    return std::optional<double>();
  }
  if (!answer) return fail(answer.error());
  const auto shown = units_->physical(*monitor, *answer);
  return shown ? std::optional(shown->value) : std::nullopt;
}

/// Counts of a turn that were measured once may be those of another motor, those that were told wrong, and
/// parameters that tell them may not be in force: what they make of 606Ch and of the speed that was asked for
/// is held against the drive's own monitor, in every look.
Result<void> Motion::check_turn(const MotionSample& sample) {
  if (units_->unit(objects::kVelocityActual) != "rpm") return {};
  const auto shown = monitored_speed();
  if (!shown) return fail(shown.error());
  if (!*shown) return {};
  if (const auto fits = check_kept_turn(sample, **shown); !fits) return fits;
  if (!told_rpm_) return {};
  const double most = std::max(*told_rpm_ * kTooFastFactor, *told_rpm_ + kTooFastRpm);
  fast_looks_ = std::abs(**shown) > most ? fast_looks_ + 1 : 0;
  if (fast_looks_ < kOddLooks) return {};
  return fail(error(Errc::negative,
                    message("turns at {} rpm by {}, but {} rpm were asked for", number_text(**shown),
                            profile_->rules.learn.speed, number_text(*told_rpm_)),
                    "its counts per revolution are probably wrong: `units learn` measures them, --turn takes "
                    "those of 6064h"));
}

/// Counts that the user has told are not compared with 606Ch: they are the way on where the monitor lies.
Result<void> Motion::check_kept_turn(const MotionSample& sample, double shown) {
  const auto speed = sample[Signal::velocity];
  if (units_->turn_way() == nullptr || !speed) return {};
  const double one = std::abs(*speed);
  const double other = std::abs(shown);
  const bool odd = std::max(one, other) >= kComparedRpm &&
                   std::max(one, other) > kMostContradiction * std::min(one, other);
  odd_looks_ = odd ? odd_looks_ + 1 : 0;
  if (odd_looks_ < kOddLooks) return {};
  return fail(quarrel(shown, *speed));
}

/// Between the monitor of the speed and 606Ch by the counts of a turn, both in rpm.
Error Motion::quarrel(double shown, double speed) const {
  const auto& name = profile_->rules.learn.speed;
  if (units_->uses_learned())
    return error(Errc::negative,
                 message("turns at {} rpm by {}, but at {} rpm by the kept counts per revolution",
                         number_text(shown), name, number_text(speed)),
                 "another motor or drive? `units learn` measures again, `units forget` deletes the counts");
  auto hint = restart_note(*profile_, *units_->turn_way());
  if (!hint.empty()) hint += "; ";
  if (const double factor = std::abs(shown / speed); is_a_ten(std::max(factor, 1 / factor)))
    if (const auto monitor = drive::resolve(profile_, name); monitor && monitor->is_contradicted("scale"))
      hint += formatted(
          "the manual states two scales of {}, a factor of ten apart: perhaps only that one is wrong; ",
          name);
  return error(
      Errc::negative,
      message("turns at {} rpm by {}, but at {} rpm by the {} increments per revolution in its parameters",
              number_text(shown), name, number_text(speed), plain_number(units_->turn().value_or(0), 12)),
      hint + "--turn gives the 6064h increments per revolution, and these are then not compared with " +
          name);
}

Result<std::optional<double>> Motion::fastest() const {
  std::optional<double> most;
  for (const auto object : {objects::kMaxProfileVelocity, objects::kMaxMotorSpeed}) {
    const auto speed = read_as(objects::kTargetVelocity, object);
    if (!speed) return speed;
    if (*speed) most = std::min(**speed, most.value_or(**speed));
  }
  return most;
}

Result<double> Motion::find_speed_cap() {
  const auto unit = units_->unit(objects::kTargetVelocity);
  const auto allowed = fastest();
  if (!allowed) return fail(allowed.error());
  auto most = *allowed;
  if (unit != "rpm") {
    supposed_turn_ = supposed_turn();
    speed_unproven_ = !supposed_turn_;
  }
  if (!options_.speed_limit.empty()) {
    const auto asked = parse_limit(objects::kTargetVelocity, "--limit", options_.speed_limit);
    if (asked && most && *asked > *most) {
      const auto numbers = told_apart(*asked, *most);
      return fail(error(Errc::refused,
                        message("the limit of {} {} is above what the drive allows, {} {}", numbers.first,
                                unit, numbers.second, unit),
                        "607Fh and 6080h set it, or --limit below it"));
    }
    return asked;
  }
  const auto rated = units_->object(rules().rated_speed);
  const auto nominal = rated ? read_as(objects::kTargetVelocity, *rated) : std::optional<double>();
  if (!nominal) return fail(nominal.error());
  if (*nominal) most = std::min(**nominal, most.value_or(**nominal));
  const auto rule = cap_of_cautions(objects::kTargetVelocity, &drive::Caution::speed);
  if (!rule) return fail(rule.error());
  if (*rule) most = std::min(**rule, most.value_or(**rule));
  return unit == "rpm" ? Result<double>(std::min(kSafeRpm, most.value_or(kSafeRpm)))
                       : find_unconverted_cap(most);
}

Result<void> Motion::check_speed(double speed) const {
  if (!options_.max_torque.empty() && !units_->has(objects::kTorqueActual))
    return fail(Errc::usage,
                "this family does not report torque (6077h), so --max-torque cannot be monitored",
                "leave this limit out");
  if (!speed_cap_) return fail(speed_cap_.error());
  if (std::abs(speed) <= *speed_cap_ * kUnitRounding) return {};
  const auto unit = units_->unit(objects::kTargetVelocity);
  // What the drive itself does not allow, no option raises.
  const auto most = fastest();
  if (!most) return fail(most.error());
  const bool beyond = *most && std::abs(speed) > **most * kUnitRounding;
  const auto numbers = told_apart(std::abs(speed), beyond ? **most : *speed_cap_);
  if (beyond)
    return fail(error(Errc::refused,
                      message("the speed of {} {} is above what the drive allows, {} {}", numbers.first, unit,
                              numbers.second, unit),
                      "607Fh and 6080h set it"));
  auto hint = message("`--limit {}{}` raises it, if the machine may move that fast", numbers.first, unit);
  if (supposed_turn_ && options_.speed_limit.empty())
    hint =
        message("add --turn, the increments per revolution: at {} of them this speed is {} rpm; {}",
                plain_number(*supposed_turn_, 12), number_text(std::abs(speed) / *supposed_turn_ * 60), hint);
  return fail(error(
      Errc::refused,
      message("the speed of {} {} is above the limit of {} {}", numbers.first, unit, numbers.second, unit),
      std::move(hint)));
}

Result<double> Motion::torque_cap() const {
  const auto unit = units_->unit(objects::kTargetTorque);
  const auto allowed = read_as(objects::kTargetTorque, objects::kMaxTorque);
  if (!allowed) return fail(allowed.error());
  const auto& most = *allowed;
  if (!options_.max_torque.empty()) {
    const auto asked = parse_limit(objects::kTargetTorque, "--max-torque", options_.max_torque);
    if (asked && most && *asked > *most * kUnitRounding) {
      const auto numbers = told_apart(*asked, *most);
      return fail(error(Errc::refused,
                        message("--max-torque of {} {} is above what the drive allows, {} {}", numbers.first,
                                unit, numbers.second, unit),
                        "6072h sets it, or --max-torque below it"));
    }
    return asked;
  }
  const auto rule = cap_of_cautions(objects::kTargetTorque, &drive::Caution::torque);
  if (!rule) return fail(rule.error());
  std::optional<double> rated = *rule;
  if (unit == "%") rated = std::min(kRatedTorque, rated.value_or(kRatedTorque));
  if (const auto object = units_->object(rules().rated_torque)) {
    const auto nominal = read_as(objects::kTargetTorque, *object);
    if (!nominal) return fail(nominal.error());
    if (*nominal) rated = std::min(**nominal, rated.value_or(**nominal));
  }
  if (rated) return std::min(*rated, most.value_or(*rated));
  return fail(Errc::usage, "a safe torque cannot be derived from this drive",
              message("add --max-torque TORQUE in {}", unit.empty() ? "the drive's own unit" : unit));
}

}  // namespace servoctl::motion
