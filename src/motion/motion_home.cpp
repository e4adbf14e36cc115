#include <algorithm>
#include <cmath>

#include "base/format.hpp"
#include "base/number.hpp"
#include "drive/homing_method.hpp"
#include "drive/standard_objects.hpp"
#include "motion/homing_methods.hpp"
#include "motion/motion_kinds.hpp"
#include "motion/motion_needs.hpp"
#include "motion/operation_mode.hpp"
#include "session/stretch.hpp"

namespace servoctl::motion {
namespace {

constexpr Duration kStart = std::chrono::seconds(1);
/// A turn of direction takes less.
constexpr Duration kAtRest = std::chrono::milliseconds(1500);
constexpr double kNearHomeDegrees = 1;
constexpr double kNearHomeCounts = 100;
/// CiA 402-2, 6098h: no homing operation.
constexpr std::int64_t kNoMethod = 0;
/// To one end of the window, from there to the other one.
constexpr double kWindows = 3;
/// The index pulse comes once in a turn; the switch may have to be left first.
constexpr double kIndexTurns = 2;
constexpr Duration kHomeSettling = std::chrono::seconds(5);

/// Such a method may be done before anybody looks.
bool takes_present_position(const MotionPlan& plan) {
  return drive::stays_put(static_cast<std::int64_t>(plan.value));
}

class Homing {
 public:
  Homing(Motion& motion, const MotionPlan& plan) : motion_(&motion), plan_(&plan) {}

  Result<void> run() {
    const auto before = motion_->watch([](const MotionSample&) -> Result<bool> { return true; }, {});
    if (!before) return fail(before.error());
    // "Homed" may stand there from an earlier run: it counts when it was seen to go.
    const auto word_before = motion_->monitor().samples().back().statusword;
    seen_low_ = begun_ = !is_done(word_before);
    stale_error_ = is_error(word_before);
    started_at_ = motion_->session().now();
    for (const auto word : motion_->rules().start_homing)
      if (const auto written = motion_->command(word); !written) return written;
    const session::Stretch stretch(motion_->session(), started_at_ + plan_->longest,
                                   session::Stretch::End::at_latest);
    const auto ended = motion_->watch([this](const MotionSample& s) { return look(s); }, plan_->longest);
    if (!ended) return fail(ended.error());
    if (*ended) return {};
    return fail(motion_->error(
        Errc::negative,
        message("no home found in {} s", std::chrono::duration<double>(plan_->longest).count()),
        "check that the switch and the index pulse come; `--within` allows more time"));
  }

  MotionReport judged(MotionReport report) const {
    if (by_standstill_ && report.outcome)
      report.unchecked.emplace_back(
          "\"homing attained\" was set all the time: that the motor moved and stopped is all that was seen");
    return report;
  }

 private:
  bool is_done(std::uint16_t word) const {
    const auto& rules = motion_->rules();
    return (word & rules.homing_done_mask) == rules.homing_done;
  }

  bool is_error(std::uint16_t word) const { return (word & motion_->rules().homing_error) != 0; }

  Result<bool> look(const MotionSample& sample) {
    stale_error_ = stale_error_ && is_error(sample.statusword) && sample.time - started_at_ < kStart;
    if (is_error(sample.statusword) && !stale_error_)
      return fail(motion_->error(
          Errc::negative, message("ended homing with an error (statusword 0x{:04X})", sample.statusword),
          "switch stuck, wrong method or a limit in the way; see also `fault show`"));
    const bool done = is_done(sample.statusword);
    seen_low_ = seen_low_ || !done;
    moved_ = moved_ || (!sample.is_cut_short && !motion_->stands_still(sample));
    if (!motion_->stands_still(sample))
      still_since_.reset();
    else if (!still_since_)
      still_since_ = sample.time;
    if (done && seen_low_) return still_since_.has_value();
    // Some drives leave "attained" set from before: what has moved has begun, and has ended where it stays.
    if (done && moved_ && still_since_ && sample.time - *still_since_ >= kAtRest) {
      by_standstill_ = true;
      return true;
    }
    begun_ = seen_low_ || moved_;
    if (begun_ || sample.time - started_at_ < kStart) return false;
    if (takes_present_position(*plan_) && motion_->stands_still(sample) && is_at_offset(sample)) return true;
    return fail(motion_->error(
        Errc::negative, "does not start homing: \"homing attained\" is from an earlier run",
        "does the drive support this method (6098h)? If it stands at its home, jog it away first"));
  }

  /// Where it stands is home now, so its position is the offset; its sign differs from drive to drive.
  bool is_at_offset(const MotionSample& sample) {
    const auto& units = motion_->units();
    const auto position = sample[Signal::position];
    if (!position || !units.has(objects::kHomeOffset) ||
        units.unit(objects::kHomeOffset) != units.unit(objects::kPositionActual))
      return true;
    const auto answer = motion_->session().upload(motion_->node(), objects::kHomeOffset);
    if (!answer && answer.error().code != Errc::sdo_abort) return false;
    const auto offset = answer ? units.physical(objects::kHomeOffset, *answer) : std::nullopt;
    const double near = units.unit(objects::kPositionActual) == "deg" ? kNearHomeDegrees : kNearHomeCounts;
    return !offset || std::abs(std::abs(*position) - std::abs(offset->value)) <= near;
  }

  Motion* motion_;
  const MotionPlan* plan_;
  bool seen_low_ = false;  ///< "Attained" was not set.
  bool moved_ = false;
  bool begun_ = false;
  bool by_standstill_ = false;
  std::optional<TimePoint> still_since_;
  bool stale_error_ = false;
  TimePoint started_at_{};
};

/// A setting the user gave goes into the plan.
Result<void> add(const Motion& motion, ObjectAddress object, const std::string& text, MotionPlan& plan) {
  if (text.empty()) return {};
  if (!motion.units().has(object))
    return fail(motion.error(Errc::usage,
                             message("{} has no object {}", as_it_is(motion.units().profile().family),
                                     as_it_is(to_string(object))),
                             "leave this option out"));
  const bool is_way = object == objects::kHomeOffset;
  const auto data =
      motion.units().parse(object, text, is_way ? MotionUnits::Kind::way : MotionUnits::Kind::size);
  if (!data) return fail(data.error());
  plan.settings.emplace_back(object, data->data);
  plan.tell(data->rounding);
  return {};
}

/// The number that will stand in the object: the new one, else what the drive holds.
Result<Bytes> value_of(Motion& motion, ObjectAddress object, const MotionPlan& plan) {
  for (const auto& [changed, data] : plan.settings)
    if (changed == object) return data;
  return motion.session().upload(motion.node(), object);
}

Result<void> check_method(Motion& motion, MotionPlan& plan) {
  const auto method = value_of(motion, objects::kHomingMethod, plan);
  if (!method) return fail(method.error());
  const auto meaning = drive::as_answered(motion.units().meaning(objects::kHomingMethod), method->size());
  const auto value = od::decode(meaning.type, *method);
  if (!value) return fail(value.error());
  const auto number = static_cast<std::int64_t>(od::to_double(*value));
  const auto& nothing = motion.rules().no_homing;
  if (number == kNoMethod || std::find(nothing.begin(), nothing.end(), number) != nothing.end())
    return fail(motion.error(
        Errc::refused, message("homing method {} (6098h) does nothing: no homing would occur", number),
        message("give one: `home METHOD -n {}`; {}, `write 0x6098 METHOD` sets one", node_name(motion.node()),
                meaning.labels != nullptr ? "`objects 0x6098` lists them" : "the manual lists them")));
  const auto* label = drive::label_of(meaning, *value);
  if (meaning.labels != nullptr && label == nullptr)
    return fail(motion.error(Errc::refused, message("this family has no homing method {}", number),
                             "`objects 0x6098` lists them"));
  const auto supported = supported_homing(motion.session(), motion.units().profile(), motion.node());
  if (!supported) return fail(supported.error());
  if (const auto has = check_homing(*supported, number, motion.node()); !has) return has;
  if (const auto possible = motion.intend({drive::Use::home, number}); !possible) return possible;
  plan.value = static_cast<double>(number);
  plan.summary = formatted("{}{}", number, label != nullptr ? " (" + label->label + ")" : "");
  return {};
}

/// One of the two speeds, which must be known and allowed.
Result<Physical> speed_of(Motion& motion, ObjectAddress object, const MotionPlan& plan) {
  const auto data = value_of(motion, object, plan);
  if (!data) return fail(data.error());
  const auto speed = motion.units().physical(object, *data);
  if (!speed || speed->unit != motion.units().unit(objects::kTargetVelocity))
    return fail(motion.error(
        Errc::refused,
        message("its homing speed ({}) cannot be compared with its speed limit", as_it_is(to_string(object))),
        motion.is_told_turn()
            ? ""
            : "add --turn (6064h increments per revolution), if the drive does not report it"));
  // Where it stands is home: no speed is used, and the motor is stopped when it turns faster than its limit.
  const bool stays = takes_present_position(plan);
  if (stays && motion.is_speed_unproven()) return *speed;
  if (const auto allowed = motion.check_speed(stays ? 0 : speed->value); !allowed)
    return fail(allowed.error());
  if (speed->value > 0 || stays) return *speed;
  const bool fast = object == objects::kHomingSpeedSwitch;
  return fail(motion.error(
      Errc::refused,
      message("its homing speed ({}) is {} {}: homing would never end", as_it_is(to_string(object)),
              number_text(speed->value), speed->unit),
      message("add {}; `write {} …` sets it",
              fast ? "--speed 30rpm (and --search 6rpm where 0x6099:2 is 0, too)" : "--search 6rpm",
              as_it_is(to_string(object)))));
}

/// From the way that --window leaves it and its speeds; a way that is not known has a time of its own.
Duration longest_homing(Motion& motion, double fast, double slow) {
  const auto window = motion.limits().travel;
  const bool in_degrees = motion.units().unit(objects::kPositionActual) == "deg";
  if (!window || !in_degrees) return kLongestHoming;
  const auto there = motion.duration(*window * kWindows, fast);
  const auto index = motion.duration(kDegreesATurn * kIndexTurns, slow);
  return there && index ? *there + *index + kHomeSettling : kLongestHoming;
}

}  // namespace

Result<MotionPlan> plan_home(Motion& motion, const Home& home) {
  const auto mode = mode_for(motion.session(), motion.units().profile(), motion.node(), drive::Use::home);
  if (!mode) return fail(mode.error());
  MotionPlan plan;
  plan.mode = *mode;
  for (const auto& [object, text] :
       {std::pair(objects::kHomingMethod, &home.method), std::pair(objects::kHomingSpeedSwitch, &home.fast),
        std::pair(objects::kHomingSpeedZero, &home.slow), std::pair(objects::kHomeOffset, &home.offset)})
    if (const auto added = add(motion, object, *text, plan); !added) return fail(added.error());
  if (const auto known = check_method(motion, plan); !known) return fail(known.error());
  const auto fast = speed_of(motion, objects::kHomingSpeedSwitch, plan);
  if (!fast) return fail(fast.error());
  auto slow = *fast;
  if (motion.units().has(objects::kHomingSpeedZero)) {
    const auto told = speed_of(motion, objects::kHomingSpeedZero, plan);
    if (!told) return fail(told.error());
    slow = *told;
  }
  plan.speed = std::max(fast->value, slow.value);
  if (takes_present_position(plan))
    plan.speed = std::min(plan.speed, motion.speed_cap().value_or(plan.speed));
  plan.unit = fast->unit;
  plan.longest = home.longest.value_or(longest_homing(motion, fast->value, slow.value));
  plan.summary = formatted("home by method {} at {} and {} {}", plan.summary, number_text(fast->value),
                           number_text(slow.value), fast->unit);
  for (const auto word : motion.rules().start_homing)
    plan.moving.emplace_back(objects::kControlword, store_le(word, 2));
  motion.set_standstill(plan.speed);
  motion.supervise_overspeed(plan.speed);
  motion.monitor().expect_new_zero();
  return plan;
}

MotionReport run_home(Motion& motion, const Home&, const MotionPlan& plan) {
  if (auto begun = motion.begin(plan.mode, plan.settings); !begun) return motion.finish(std::move(begun));
  Homing homing(motion, plan);
  auto done = homing.run();
  return homing.judged(motion.finish(std::move(done)));
}

}  // namespace servoctl::motion
