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

constexpr Duration kJogSettling = std::chrono::milliseconds(1500);
/// So long after the command a motor that obeys turns, and the right way round.
constexpr Duration kMostDelay = std::chrono::milliseconds(1500);
/// Of the commanded speed, once that should be reached.
constexpr double kLeastPartOfSpeed = 0.5;
constexpr double kMostTurns = 1e6;
constexpr Duration kForEver = std::chrono::hours(24);

class Jogging {
 public:
  Jogging(Motion& motion, const Jog& jog, const MotionPlan& plan)
      : motion_(&motion), jog_(&jog), plan_(&plan) {}

  Result<void> run() {
    const auto began_at = motion_->session().now();
    if (!jog_->keys)
      if (const auto started = turn(1); !started) return started;
    const auto told_at = motion_->session().now();
    if (!jog_->keys) stretch_.emplace(motion_->session(), jog_->length ? told_at + *jog_->length : kNever);
    const auto watched =
        motion_->watch([this](const MotionSample& s) { return look(s); }, jog_->length.value_or(longest()));
    if (!watched) return fail(watched.error());
    if (!*watched && jog_->turns)
      return fail(motion_->error(Errc::negative, "did not turn that far in the expected time",
                                 "is it blocked, or is its speed limited?"));
    const auto stopped_at = motion_->session().now();
    stretch_.reset();
    const auto stopped = stop();
    const auto let_go_at = motion_->session().now();
    auto rested = stopped ? motion_->wait_for_rest(kJogSettling) : stopped;
    if (!rested) return rested;
    judge(told_at, stopped_at);
    if (jog_->length) {
      judgement_.judge_time(*jog_->length, began_at, let_go_at);
      judgement_.judge_way_in_time(*motion_, *plan_, *jog_->length);
    }
    return rested;
  }
  MotionJudgement& judgement() { return judgement_; }

 private:
  void judge(TimePoint told_at, TimePoint stopped_at) {
    if (left_alone_)
      judgement_.unchecked.push_back(
          formatted("no key was held for {}: the jog has ended", servoctl::to_string(kLongestWithoutKey)));
    if (jog_->keys) return;
    judgement_.judge_speed(*motion_, *plan_, told_at, stopped_at);
    if (jog_->turns) judgement_.judge_way(*motion_, *plan_);
  }

  Duration longest() const {
    if (!jog_->turns) return kForEver;
    return motion_->duration(plan_->way, plan_->speed).value_or(kForEver) * 3 / 2 + kJogSettling;
  }

  Result<void> turn(int direction) {
    direction_ = direction;
    since_ = motion_->session().now();
    wrong_looks_ = 0;
    Bytes data(plan_->command.size(), 0);
    if (direction == 1) data = plan_->command;
    if (direction == -1)
      data = motion_->units().bytes(objects::kTargetVelocity, -plan_->value).value_or(data);
    return motion_->write(objects::kTargetVelocity, data);
  }

  Result<bool> look(const MotionSample& sample) {
    if (const auto follows = check_following(sample); !follows) return fail(follows.error());
    if (jog_->keys) return look_at_keys();
    return jog_->turns && is_far_enough(sample);
  }

  Result<bool> look_at_keys() {
    const auto key = jog_->keys();
    if (key == HoldKey::stop) return true;
    const int wanted = key == HoldKey::plus ? 1 : key == HoldKey::minus ? -1 : 0;
    const auto now = motion_->session().now();
    if (wanted != 0 || !held_at_) held_at_ = now;
    if (now - *held_at_ >= kLongestWithoutKey) {
      left_alone_ = true;
      return true;
    }
    if (wanted == direction_) return false;
    if (const auto done = turn(wanted); !done) return fail(done.error());
    return false;
  }

  /// With the way it still needs to come to rest.
  bool is_far_enough(const MotionSample& sample) {
    const auto position = sample[Signal::position];
    if (!position) return false;
    if (!begin_) begin_ = *position;
    const double seconds = std::chrono::duration<double>(sample.time - last_time_).count();
    const double rate = last_ && seconds > 0 ? std::abs(*position - *last_) / seconds : 0;
    last_ = *position;
    last_time_ = sample.time;
    const double gone = std::abs(*position - *begin_) + rate * Motion::kRampSeconds / 2;
    if (plan_->way > 0 && stretch_) stretch_->set_share(gone / plan_->way);
    return gone >= plan_->way;
  }

  Result<void> check_following(const MotionSample& sample) {
    auto speed = sample[Signal::velocity];
    if (!speed && !sample.is_cut_short) speed = motion_->monitor().by_position();
    if (direction_ == 0 || !speed) return {};
    const double wanted = plan_->value * direction_;
    const bool wrong = *speed * wanted < 0 && std::abs(*speed) > std::abs(wanted) * kTurningPart;
    // After a change of direction it turns the old way for a while.
    const bool settled = sample.time - since_ >= kMostDelay;
    wrong_looks_ = wrong && (settled || !turned_before_) ? wrong_looks_ + 1 : 0;
    turned_before_ = turned_before_ || (!wrong && std::abs(*speed) > std::abs(wanted) * kTurningPart);
    if (wrong_looks_ >= kWrongLooks)
      return fail(motion_->error(Errc::negative,
                                 message("turns the wrong way: {} {} instead of {}", number_text(*speed),
                                         plan_->unit, number_text(wanted)),
                                 "check encoder direction, polarity (607Eh), motor wiring"));
    if (settled && std::abs(*speed) < std::abs(wanted) * kTurningPart)
      return fail(motion_->error(Errc::negative, "does not turn although commanded to",
                                 "is it blocked, is the brake on, or does a limit hold it back?"));
    // Ramps of the user's own take their time.
    if (settled && !motion_->has_own_ramps() && std::abs(*speed) < std::abs(wanted) * kLeastPartOfSpeed)
      return fail(motion_->error(Errc::negative,
                                 message("turns at {} {}, less than half of the {} that were commanded",
                                         number_text(*speed), plan_->unit, number_text(wanted)),
                                 "is it blocked, or is its speed limited (607Fh, 6080h)?"));
    return {};
  }

  Result<void> stop() { return direction_ == 0 ? Result<void>() : turn(0); }

  Motion* motion_;
  const Jog* jog_;
  const MotionPlan* plan_;
  int direction_ = 0;
  TimePoint since_{};
  bool turned_before_ = false;
  int wrong_looks_ = 0;
  std::optional<double> begin_;
  std::optional<double> last_;
  TimePoint last_time_{};
  std::optional<TimePoint> held_at_;  ///< When a key was held last.
  bool left_alone_ = false;
  std::optional<session::Stretch> stretch_;
  MotionJudgement judgement_;
};

/// The way of so many turns in the unit of the position.
Result<double> way_of(const Motion& motion, double turns) {
  if (!(std::abs(turns) <= kMostTurns))
    return fail(Errc::usage, message("--turns: more than {} turns are no jog", number_text(kMostTurns)));
  if (motion.units().unit(objects::kPositionActual) == "deg") return std::abs(turns) * kDegreesATurn;
  return fail(motion.error(Errc::usage, "does not report its counts per motor revolution",
                           "add --turn (6064h increments per revolution), or use --for TIME"));
}

std::string jog_text(const std::string& speed, const Jog& jog) {
  if (jog.length) return formatted("turn at {} for {}", speed, servoctl::to_string(*jog.length));
  if (jog.turns) return formatted("turn at {} for {} turns", speed, number_text(*jog.turns));
  return formatted("turn at {} while an arrow key is held", speed);
}

}  // namespace

Result<MotionPlan> plan_jog(Motion& motion, const Jog& jog) {
  const auto mode = mode_for(motion.session(), motion.units().profile(), motion.node(), drive::Use::jog);
  if (!mode) return fail(mode.error());
  if (const auto possible = motion.intend({drive::Use::jog}); !possible) return fail(possible.error());
  MotionPlan plan;
  plan.mode = *mode;
  const auto data = motion.units().parse(objects::kTargetVelocity, jog.speed, MotionUnits::Kind::way);
  if (!data) return fail(data.error());
  const auto& speed = data->value;
  if (speed.value == 0) return fail(Errc::usage, "a speed of 0 moves nothing", "give a speed other than 0");
  if (const auto allowed = motion.check_speed(speed.value); !allowed) return fail(allowed.error());
  plan.command = data->data;
  plan.tell(data->rounding);
  plan.value = plan.speed = speed.value;
  plan.unit = speed.unit;
  if (const auto ramps =
          motion.add_ramps(speed.value, {objects::kProfileAcceleration, objects::kProfileDeceleration}, plan);
      !ramps)
    return fail(ramps.error());
  if (jog.turns) {
    const auto way = way_of(motion, *jog.turns);
    if (!way) return fail(way.error());
    plan.way = *way;
  }
  plan.summary = jog_text(motion.units().words(speed.value, speed.unit), jog);
  plan.moving = {{objects::kTargetVelocity, plan.command},
                 {objects::kTargetVelocity, Bytes(plan.command.size(), 0)}};
  motion.set_standstill(speed.value);
  motion.supervise_overspeed(speed.value);
  return plan;
}

MotionReport run_jog(Motion& motion, const Jog& jog, const MotionPlan& plan) {
  if (auto begun = motion.begin(plan.mode, plan.settings); !begun) return motion.finish(std::move(begun));
  Jogging jogging(motion, jog, plan);
  auto done = jogging.run();
  return jogging.judgement().into(motion.finish(std::move(done)));
}

}  // namespace servoctl::motion
