// How many counts a turn of the motor has, by a slow turn against the drive's own monitor of the speed.
#include <cmath>

#include "base/duration.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "drive/standard_objects.hpp"
#include "motion/motion_kinds.hpp"
#include "motion/motion_needs.hpp"
#include "motion/speed_monitor.hpp"
#include "session/stretch.hpp"

namespace servoctl::motion {
namespace {

/// From a new speed until the motor turns evenly at it: the ramp, and what a drive may add to it.
constexpr Duration kSpeedSettling = std::chrono::milliseconds(800);
/// The end of that time, by which the speed is judged.
constexpr Duration kJudged = std::chrono::milliseconds(250);
constexpr Duration kRest = std::chrono::milliseconds(1500);
constexpr double kNoise = 5;          ///< rpm that a monitor may show beyond what was asked.
constexpr double kTooFast = 1.5;      ///< Of the speed that was asked.
constexpr double kSteps = 5;          ///< Steps of the monitor that show a speed well enough to go by,
constexpr double kErrors = 4;         ///< and standard errors of what it showed.
constexpr double kSpeedUp = 4;        ///< From one speed to the next.
constexpr double kBlind = 10;         ///< Of the first speed, while the monitor shows nothing.
constexpr double kNearEnough = 0.1;   ///< Of the speed that was asked.
constexpr double kMostChange = 0.35;  ///< Of counts a turn from one speed to the next; coarse at low ones.
constexpr int kMostSpeeds = 20;

class Learning {
 public:
  Learning(Motion& motion, const Learn& learn, double first, std::optional<double> fastest)
      : motion_(&motion), learn_(&learn), first_(first), fastest_(fastest), monitor_(motion, learn) {}

  Result<void> run() {
    if (const auto found = find_speed(); !found) return found;
    looks_.clear();
    keeps_ = true;
    const session::Stretch stretch(motion_->session(), motion_->session().now() + learn_->length);
    if (const auto watched = watch(learn_->length); !watched) return watched;
    keeps_ = false;
    return rest();
  }
  Result<TurnMeasurement> measurement() const {
    auto out = measure_turn(looks_, monitor_.step());
    if (!out) return fail(motion_->error(out.error().code, out.error().message, out.error().hint));
    return out;
  }

 private:
  /// Faster and faster until the monitor shows the speed that was asked; while it shows nothing, never faster
  /// than a motor of the fewest counts may turn.
  Result<void> find_speed() {
    std::optional<double> known;  // Increments a second at 1 rpm.
    double speed = limited(first_);
    for (int i = 0; i < kMostSpeeds; ++i) {
      if (const auto turned = turn(speed); !turned) return turned;
      const double rpm = std::abs(shown_);
      if (rpm < std::max(kSteps * monitor_.step(), kErrors * error_)) {
        const double next = limited(std::min(speed * kSpeedUp, first_ * kBlind));
        if (next <= speed) return fail(shows_nothing(speed));
        speed = next;
        continue;
      }
      const double now = speed / rpm;
      if (known && std::abs(now / *known - 1) > kMostChange) return fail(lies(speed));
      known = now;
      const double next =
          limited(std::clamp(now * std::abs(learn_->rpm), speed / kSpeedUp, speed * kSpeedUp));
      if (std::abs(next / speed - 1) <= kNearEnough) return {};
      speed = next;
    }
    return fail(lies(speed));
  }

  double limited(double speed) const { return fastest_ ? std::min(speed, *fastest_) : speed; }
  double direction() const { return std::copysign(1, learn_->rpm); }

  /// Turns at so many increments a second until that is even.
  Result<void> turn(double speed) {
    wanted_ = speed * direction();
    wrong_looks_ = 0;
    motion_->set_standstill(speed);
    motion_->supervise_overspeed(std::max(speed, std::abs(last_wanted_)));
    MotionPlan ramps;
    if (const auto added =
            motion_->add_ramps(speed, {objects::kProfileAcceleration, objects::kProfileDeceleration}, ramps);
        !added)
      return added;
    for (const auto& [object, data] : ramps.settings)
      if (const auto done = motion_->write(object, data); !done) return done;
    const auto data = motion_->units().bytes(objects::kTargetVelocity, wanted_);
    if (!data)
      return fail(motion_->error(Errc::refused,
                                 "its target velocity (60FFh) cannot be set: its type or unit is not known"));
    if (const auto done = motion_->write(objects::kTargetVelocity, *data); !done) return done;
    looks_.clear();
    if (const auto watched = watch(kSpeedSettling); !watched) return watched;
    last_wanted_ = wanted_;
    return judge();
  }

  /// With the look at its end.
  Result<void> watch(Duration length) {
    const auto watched = motion_->watch([this](const MotionSample& sample) { return look(sample); },
                                        length + MotionMonitor::kPeriod);
    if (!watched) return fail(watched.error());
    return {};
  }

  Result<bool> look(const MotionSample& sample) {
    const auto rpm = monitor_.read();
    if (!rpm) return fail(rpm.error());
    if (std::abs(*rpm) > std::abs(learn_->rpm) * kTooFast + kNoise)
      return fail(
          motion_->error(Errc::negative,
                         message("turns too fast: {} shows {} rpm instead of {}", learn_->monitor_name,
                                 number_text(*rpm), number_text(std::abs(learn_->rpm))),
                         "fewer encoder counts than the family's data says? " + std::string(kOtherWay)));
    const auto position = sample[Signal::position];
    if (!position)
      return fail(motion_->error(Errc::negative, "does not report its position (6064h) while moving"));
    const auto speed = sample[Signal::velocity];
    if (!speed) return fail(motion_->error(Errc::negative, "does not report its speed (606Ch) while moving"));
    looks_.push_back({sample.time, *position, *speed, *rpm});
    const bool wrong = !keeps_ && *speed * wanted_ < 0 && std::abs(*speed) > std::abs(wanted_) * kTurningPart;
    wrong_looks_ = wrong ? wrong_looks_ + 1 : 0;
    if (wrong_looks_ >= kWrongLooks)
      return fail(motion_->error(Errc::negative, "turns the wrong way",
                                 "check encoder direction, polarity (607Eh), motor wiring"));
    return false;
  }

  /// What was shown at the end of the time since the last command.
  Result<void> judge() {
    const auto since = motion_->session().now() - kJudged;
    double rpm = 0;
    double squares = 0;
    double speed = 0;
    int count = 0;
    for (const auto& one : looks_) {
      if (one.time < since && &one != &looks_.back()) continue;
      rpm += one.rpm;
      squares += one.rpm * one.rpm;
      speed += one.speed;
      ++count;
    }
    shown_ = rpm / count;
    error_ = std::sqrt(std::max(squares / count - shown_ * shown_, 0.0) / count);
    if (std::abs(speed / count) >= std::abs(wanted_) * kTurningPart) return {};
    return fail(motion_->error(Errc::negative, "does not turn although commanded to",
                               "is it blocked, is the brake on, or does a limit hold it back?"));
  }

  Error shows_nothing(double speed) const {
    return motion_->error(
        Errc::negative,
        message("turns at {} inc/s by 606Ch, but {} shows {} rpm: not usable", number_text(speed),
                learn_->monitor_name, number_text(shown_)),
        (fastest_ && speed >= *fastest_ ? "607Fh limits it; " : "") + std::string(kOtherWay));
  }
  Error lies(double speed) const {
    return motion_->error(
        Errc::negative,
        message(
            "turns at {} inc/s by 606Ch, but {} shows {} rpm, which contradicts its values at other speeds",
            number_text(speed), learn_->monitor_name, number_text(shown_)),
        std::string(kOtherWay));
  }

  Result<void> rest() {
    const auto data = motion_->units().bytes(objects::kTargetVelocity, 0);
    if (data)
      if (const auto told = motion_->write(objects::kTargetVelocity, *data); !told) return told;
    return motion_->wait_for_rest(kRest);
  }

  Motion* motion_;
  const Learn* learn_;
  double first_;  ///< Increments a second.
  std::optional<double> fastest_;
  SpeedMonitor monitor_;
  double wanted_ = 0;
  double last_wanted_ = 0;
  double shown_ = 0;  ///< By the monitor, at the last speed,
  double error_ = 0;  ///< with this standard error.
  bool keeps_ = false;
  int wrong_looks_ = 0;
  std::vector<TurnLook> looks_;
};

/// From rest to rest: the measurement, and about two seconds of its speed on the way to it and back.
long turns_of(const Learn& learn) {
  constexpr double kOnTheWay = 2;
  return std::lround(std::abs(learn.rpm) / 60 *
                     (std::chrono::duration<double>(learn.length).count() + kOnTheWay));
}

Result<void> check_units(const Motion& motion, const Learn& learn) {
  const auto& units = motion.units();
  if (units.unit(objects::kPositionActual) != "inc" || units.unit(objects::kTargetVelocity) != "inc/s" ||
      units.unit(learn.monitor) != "rpm")
    return fail(motion.error(Errc::refused, "does not report its position and speed in counts",
                             "there is nothing to learn"));
  return {};
}

}  // namespace

Result<MotionPlan> plan_learn(Motion& motion, const Learn& learn) {
  const auto mode = mode_for(motion.session(), motion.units().profile(), motion.node(), drive::Use::jog);
  if (!mode) return fail(mode.error());
  if (const auto possible = motion.intend({drive::Use::jog}); !possible) return fail(possible.error());
  if (const auto counted = check_units(motion, learn); !counted) return fail(counted.error());
  if (const auto still = SpeedMonitor(motion, learn).check_still(); !still) return fail(still.error());
  MotionPlan plan;
  plan.mode = *mode;
  plan.value = plan.speed = std::abs(learn.rpm) / 60 * learn.least * learn.gear;
  plan.unit = motion.units().unit(objects::kTargetVelocity);
  const auto data = motion.units().bytes(objects::kTargetVelocity, std::copysign(plan.value, learn.rpm));
  if (!data)
    return fail(motion.error(Errc::refused,
                             "its target velocity (60FFh) cannot be set: its type or unit is not known"));
  plan.command = *data;
  if (const auto ramps =
          motion.add_ramps(plan.value, {objects::kProfileAcceleration, objects::kProfileDeceleration}, plan);
      !ramps)
    return fail(ramps.error());
  plan.summary = formatted("turn at {} rpm by {} for {}, about {} turns, approached in steps from {} {}",
                           number_text(learn.rpm), learn.monitor_name, servoctl::to_string(learn.length),
                           turns_of(learn), number_text(std::round(plan.value)), plan.unit);
  plan.tell(formatted(
      "60FFh and its ramps are written in steps, each for at most {} times the last speed, until {} shows {} "
      "rpm",
      number_text(kSpeedUp), learn.monitor_name, number_text(std::abs(learn.rpm))));
  plan.moving = {{objects::kTargetVelocity, plan.command},
                 {objects::kTargetVelocity, Bytes(plan.command.size(), 0)}};
  motion.set_standstill(plan.value);
  motion.limit_by_monitor();
  motion.supervise_overspeed(plan.value);
  return plan;
}

LearnReport run_learn(Motion& motion, const Learn& learn, const MotionPlan& plan) {
  LearnReport out;
  const auto fastest = motion.fastest();
  if (!fastest) {
    out.motion = motion.finish(fail(fastest.error()));
    return out;
  }
  if (auto begun = motion.begin(plan.mode, plan.settings); !begun) {
    out.motion = motion.finish(std::move(begun));
    return out;
  }
  Learning learning(motion, learn, plan.value, *fastest);
  const auto turned = learning.run();
  Result<void> outcome = turned;
  if (turned) {
    const auto measured = learning.measurement();
    if (measured) out.measured = *measured;
    auto counts =
        measured ? counts_behind(measured->increments / learn.gear, measured->uncertainty, learn.expected)
                 : Result<TurnCounts>(fail(measured.error()));
    if (counts)
      out.counts = std::move(*counts);
    else if (measured)
      outcome = fail(motion.error(counts.error().code, counts.error().message, counts.error().hint));
    else
      outcome = fail(measured.error());
  }
  out.motion = motion.finish(std::move(outcome));
  if (!out.motion.outcome || !out.motion.end.verified) out.counts.reset();
  return out;
}

}  // namespace servoctl::motion
