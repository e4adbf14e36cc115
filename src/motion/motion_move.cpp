#include <algorithm>
#include <cmath>

#include "base/format.hpp"
#include "base/number.hpp"
#include "drive/standard_objects.hpp"
#include "motion/motion_judgement.hpp"
#include "motion/motion_kinds.hpp"
#include "motion/motion_needs.hpp"
#include "motion/operation_mode.hpp"
#include "session/stretch.hpp"

namespace servoctl::motion {
namespace {

constexpr std::uint16_t kEnabled = 0x000F;
constexpr std::uint16_t kNewSetpoint = 0x001F;
constexpr std::uint16_t kAcknowledged = 1U << 12U;
constexpr std::uint16_t kFollowingErrorBit = 1U << 13U;

constexpr Duration kHandshake = std::chrono::seconds(1);
constexpr Duration kMoveSettling = std::chrono::seconds(2);
constexpr Duration kUnknownDuration = std::chrono::seconds(60);
/// Nearer than this counts as there, unless 6067h says otherwise: a motor that holds a position trembles a
/// little.
constexpr double kNearDegrees = 0.5;
constexpr double kNearCounts = 10;
/// A motor that has not moved is not there, however short the way.
constexpr double kMostOfWay = 0.5;
/// So much of the way the target may be further off than at the start.
constexpr double kMostAstray = 0.05;
constexpr double kDefaultPart = 0.2;

double near(const MotionPlan& plan) { return plan.unit == "deg" ? kNearDegrees : kNearCounts; }

class Moving {
 public:
  Moving(Motion& motion, const MotionPlan& plan) : motion_(&motion), plan_(&plan) {}

  Result<void> run() {
    if (const auto window = read_window(); !window) return window;
    if (const auto written = motion_->write(objects::kTargetPosition, plan_->command); !written)
      return written;
    if (motion_->rules().handshake)
      if (const auto taken = hand_over(); !taken) return taken;
    const auto longest = motion_->duration(plan_->way, plan_->speed).value_or(kUnknownDuration) * 3 / 2;
    session::Stretch stretch(motion_->session(), kNever);
    const auto arrived = motion_->watch(
        [&](const MotionSample& s) {
          if (const auto at = s[Signal::position]; at && plan_->way != 0)
            stretch.set_share(1 - std::abs((plan_->value - *at) / plan_->way));
          return is_there(s);
        },
        longest + kMoveSettling);
    if (!arrived) return fail(arrived.error());
    if (*arrived) {
      judgement_.judge_target(*motion_, *plan_, nearness());
      return {};
    }
    return fail(
        motion_->error(Errc::negative,
                       message("did not reach {} {} in the expected time; it is at {}",
                               number_text(plan_->value), plan_->unit, number_text(last_)),
                       "is it blocked, is its speed limited, or is the position window (6067h) too narrow?"));
  }
  const MotionJudgement& judgement() const { return judgement_; }

 private:
  double nearness() const {
    return plan_->way == 0 ? near(*plan_) : std::min(near(*plan_), std::abs(plan_->way) * kMostOfWay);
  }

  Result<void> read_window() {
    window_ = near(*plan_);
    if (!motion_->units().has(objects::kPositionWindow)) return {};
    const auto answer = motion_->session().upload(motion_->node(), objects::kPositionWindow);
    if (!answer && answer.error().code != Errc::sdo_abort) return fail(answer.error());
    const auto told = answer ? motion_->units().physical(objects::kPositionWindow, *answer) : std::nullopt;
    if (told && told->unit == plan_->unit) window_ = std::max(window_, told->value);
    if (plan_->way != 0) window_ = std::min(window_, std::abs(plan_->way) * kMostOfWay);
    return {};
  }

  /// Bit 12 is low, bit 4 rises, bit 12 answers, bit 4 falls (CiA 402-2, 10.4.2). A drive that holds one
  /// target only keeps bit 12 high until it is there.
  Result<void> hand_over() {
    const auto wait = [this](bool high) {
      return motion_->watch(
          [high](const MotionSample& s) -> Result<bool> {
            return ((s.statusword & kAcknowledged) != 0) == high;
          },
          kHandshake);
    };
    for (const auto word : {kEnabled, kNewSetpoint}) {
      if (const auto written = motion_->command(word); !written) return written;
      const bool taken = word == kNewSetpoint;
      const auto answered = wait(taken);
      if (!answered) return fail(answered.error());
      if (!*answered)
        return fail(
            motion_->error(Errc::negative,
                           taken ? "target not accepted: statusword bit 12 (acknowledge) stayed 0"
                                 : "is not ready for a target: statusword bit 12 (acknowledge) stayed 1",
                           "does another master control it?"));
    }
    return motion_->command(kEnabled);
  }

  Result<bool> is_there(const MotionSample& sample) {
    if (motion_->rules().handshake && (sample.statusword & kFollowingErrorBit) != 0)
      return fail(motion_->error(Errc::negative, "reports a following error (bit 13 of the statusword)",
                                 "is it blocked, or are its ramps too steep for the load?"));
    const auto position = sample[Signal::position];
    last_ = position.value_or(last_);
    if (const auto right = check_direction(position); !right) return fail(right.error());
    const bool near = !position || std::abs(*position - plan_->value) <= window_;
    return (sample.statusword & kTargetReached) != 0 && near && motion_->stands_still(sample);
  }

  /// The way that is left does not grow: else the motor goes where nobody sent it.
  Result<void> check_direction(std::optional<double> position) const {
    if (!position) return {};
    const double way = std::abs(plan_->way);
    const double away = std::abs(plan_->value - *position) - way;
    if (away <= std::max(window_, way * kMostAstray)) return {};
    return fail(
        motion_->error(Errc::negative,
                       message("goes the wrong way: it is at {} {}, further from {} than at the start",
                               number_text(*position), plan_->unit, number_text(plan_->value)),
                       "check encoder direction, polarity (607Eh), motor wiring"));
  }

  Motion* motion_;
  const MotionPlan* plan_;
  double window_ = 0;
  double last_ = 0;
  MotionJudgement judgement_;
};

bool is_float(const drive::Meaning& what) {
  return what.encoding != od::Encoding::plain || od::is_real(what.type);
}

/// The farther away, the greater are the steps of a number of 32 bits; where they are greater than what
/// counts as there, no target is one.
Result<void> check_precision(const MotionUnits& units, const MotionPlan& plan) {
  constexpr double kStepOfFloat = 1.0 / (1U << 23U);
  const double step = std::abs(plan.value) * kStepOfFloat;
  if (!is_float(units.meaning(objects::kTargetPosition)) || step <= near(plan)) return {};
  return fail(Errc::usage,
              message("{} is too far: a number of 32 bits has steps of {} there",
                      units.words(plan.value, plan.unit), units.words(step, plan.unit)),
              "choose a target nearer to zero; `home` sets a new one");
}

/// What one count of 607Ah is worth in the unit people think in; numbers of 32 bits have steps that grow.
double step_of(const MotionUnits& units, double place) {
  const auto what = units.meaning(objects::kTargetPosition);
  if (is_float(what)) return std::max(1e-3, std::abs(place) * 1e-6);
  const auto one = od::encode(what.type, od::Value(std::int64_t{1}));
  const auto step = one ? units.physical(objects::kTargetPosition, *one) : std::nullopt;
  return step ? std::abs(step->value) : 0;
}

/// The target, counted from where the motor stands when it is relative.
Result<void> find_target(Motion& motion, const Move& move, MotionPlan& plan) {
  const auto& units = motion.units();
  const auto asked = units.parse_physical(objects::kTargetPosition, move.target, MotionUnits::Kind::way);
  if (!asked) return fail(asked.error());
  const auto answer = motion.session().upload(motion.node(), objects::kPositionActual);
  if (!answer) return fail(answer.error());
  const auto here = units.physical(objects::kPositionActual, *answer).value_or(Physical{});
  plan.value = asked->value + (move.relative ? here.value : 0);
  plan.unit = asked->unit;
  plan.way = plan.value - here.value;
  plan.from = here.value;
  if (const auto precise = check_precision(units, plan); !precise) return precise;
  const auto data = units.bytes(objects::kTargetPosition, plan.value);
  const auto said = data ? units.physical(objects::kTargetPosition, *data) : std::nullopt;
  const double step = step_of(units, plan.value);
  // Kept within limits silently it would go elsewhere.
  if (!said || std::abs(said->value - plan.value) > std::max(step, std::abs(plan.value) * 1e-6))
    return fail(motion.error(
        Errc::usage, message("{} {} is out of the range of 607Ah", number_text(plan.value), plan.unit)));
  const double from = move.relative ? here.value : 0;
  // What was told must not be lost in a step; the zero it is counted from is one.
  const auto rounding = drive::judge_rounding({asked->value, said->value - from, step, plan.unit});
  if (!rounding) return fail(rounding.error());
  if (*rounding) plan.tell(drive::to_string(**rounding));
  plan.value = said->value;
  plan.way = plan.value - here.value;
  plan.command = *data;
  return {};
}

/// The way was told, and agreed to, from where the motor stood then.
Result<void> check_start(Motion& motion, const MotionPlan& plan) {
  if (const auto heard = motion.session().listen(); !heard) return heard;
  const auto answer = motion.session().upload(motion.node(), objects::kPositionActual);
  if (!answer) return fail(answer.error());
  const auto here = motion.units().physical(objects::kPositionActual, *answer).value_or(Physical{});
  if (!plan.from || std::abs(here.value - *plan.from) <= near(plan)) return {};
  return fail(motion.error(Errc::refused,
                           message("has moved since the preflight check: it was at {} {} and is at {}",
                                   number_text(*plan.from), plan.unit, number_text(here.value)),
                           "nothing was moved; run the command again"));
}

Result<ObjectAddress> speed_object_of(const Motion& motion) {
  const auto& name = motion.rules().position_speed;
  const auto object = motion.units().object(name);
  if (object && motion.units().has(*object)) return *object;
  return fail(motion.error(Errc::refused, message("{} has no object for the speed of a move ({})",
                                                  as_it_is(motion.units().profile().family), name)));
}

/// The speed that was asked for, else a part of what is allowed; empty where its unit is not known.
Result<std::optional<Bytes>> move_speed(Motion& motion, const Move& move, ObjectAddress object,
                                        MotionPlan& plan) {
  if (move.speed.empty()) {
    if (motion.is_speed_unproven()) return fail(unproven_speed(motion));
    const auto cap = motion.speed_cap();
    if (!cap) return fail(cap.error());
    return motion.units().bytes(object, *cap * kDefaultPart);
  }
  const auto asked = motion.units().parse(object, move.speed, MotionUnits::Kind::size);
  if (!asked) return fail(asked.error());
  plan.tell(asked->rounding);
  return std::optional<Bytes>(asked->data);
}

}  // namespace

Result<MotionPlan> plan_move(Motion& motion, const Move& move) {
  const auto mode = mode_for(motion.session(), motion.units().profile(), motion.node(), drive::Use::move);
  if (!mode) return fail(mode.error());
  if (const auto possible = motion.intend({drive::Use::move}); !possible) return fail(possible.error());
  const auto& units = motion.units();
  const auto speed_object = speed_object_of(motion);
  if (!speed_object) return fail(speed_object.error());
  MotionPlan plan;
  plan.mode = *mode;
  if (const auto found = find_target(motion, move, plan); !found) return fail(found.error());
  auto speed = move_speed(motion, move, *speed_object, plan);
  if (!speed) return fail(speed.error());
  const auto fast = *speed ? units.physical(*speed_object, **speed) : std::nullopt;
  if (!fast || fast->value <= 0)
    return fail(Errc::usage, "a move needs a speed above 0", "add --speed 60rpm");
  if (const auto allowed = motion.check_speed(fast->value); !allowed) return fail(allowed.error());
  plan.speed = fast->value;
  if (const auto window = motion.limits().travel; window && std::abs(plan.way) > *window)
    return fail(
        motion.error(Errc::refused,
                     message("the way of {} is longer than --window allows, {}",
                             units.words(plan.way, plan.unit), units.words(*window, plan.unit)),
                     "nothing was moved; --window is the longest way of one motion, from where it begins"));
  if (const auto ramps =
          motion.add_ramps(plan.speed, {objects::kProfileAcceleration, objects::kProfileDeceleration}, plan);
      !ramps)
    return fail(ramps.error());
  plan.settings.emplace_back(*speed_object, **speed);
  if (*speed_object == objects::kTargetVelocity) plan.kept_target = *speed_object;
  plan.moving = {{objects::kTargetPosition, plan.command}};
  if (motion.rules().handshake)
    for (const auto word : {kEnabled, kNewSetpoint, kEnabled})
      plan.moving.emplace_back(objects::kControlword, store_le(word, 2));
  plan.summary = formatted("go by {}, to {}, at {}", units.words(plan.way, plan.unit),
                           units.words(plan.value, plan.unit), units.words(plan.speed, fast->unit));
  motion.set_standstill(plan.speed);
  motion.supervise_overspeed(plan.speed);
  return plan;
}

MotionReport run_move(Motion& motion, const Move&, const MotionPlan& plan) {
  if (auto still = check_start(motion, plan); !still) return motion.finish(std::move(still));
  if (auto begun = motion.begin(plan.mode, plan.settings, plan.kept_target); !begun)
    return motion.finish(std::move(begun));
  Moving moving(motion, plan);
  auto done = moving.run();
  return moving.judgement().into(motion.finish(std::move(done)));
}

}  // namespace servoctl::motion
