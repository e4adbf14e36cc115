#include "motion/motion.hpp"

#include <algorithm>
#include <cmath>
#include <new>

#include "base/format.hpp"
#include "base/number.hpp"
#include "drive/soft_ramp.hpp"
#include "drive/standard_objects.hpp"
#include "motion/motion_kinds.hpp"
#include "motion/other_axes.hpp"
#include "motion/producer_claim.hpp"
#include "session/option_scope.hpp"
#include "show/owed_restart.hpp"

namespace servoctl::motion {
namespace {

/// A motor at rest shows some noise: this part of the commanded speed, and 3 rpm where it is told in rpm.
constexpr double kNoisePart = 0.02;
constexpr double kNoiseRpm = 3;
/// A motor is run away that turns so much faster than it was told to, and more than its noise.
constexpr double kOverspeed = 1.5;
constexpr double kNoiseOfOverspeed = 5;
constexpr double kLongest = 86'400;  ///< Seconds; longer is for ever.
/// What servoctl chose itself need not be met exactly; what is farther off is told.
constexpr double kChosenLoss = 0.1;

/// The drive was asked, and what it says is not known.
bool is_unanswered(const Error& error) {
  return error.code != Errc::usage && error.code != Errc::refused && error.code != Errc::sdo_abort;
}

}  // namespace

Motion::Motion(session::Session& session, const drive::Profile& profile, std::uint8_t node,
               MotionOptions options)
    : session_(&session),
      profile_(&profile),
      node_(node),
      options_(std::move(options)),
      power_(session, profile, node) {}

Result<void> Motion::prepare() {
  if (const auto alive = power_.statusword(); !alive) return fail(without_first_axis(alive.error()));
  units_ = std::make_unique<MotionUnits>(*session_, *profile_, node_, options_.turn, options_.encoder,
                                         options_.learned, options_.load);
  if (const auto& lost = units_->unanswered()) return fail(*lost);
  if (const auto in_force = check_units_in_force(); !in_force) return in_force;
  monitor_ = std::make_unique<MotionMonitor>(*session_, *units_, node_);
  auto panel = checked_panel(*profile_, options_.panel);
  if (!panel) return fail(panel.error());
  options_.panel = std::move(*panel);
  if (const auto done = read_limits(); !done) return done;
  speed_cap_ = find_speed_cap();
  if (!speed_cap_ && is_unanswered(speed_cap_.error())) return fail(speed_cap_.error());
  return {};
}

/// A device may have a second axis and no first one.
Error Motion::without_first_axis(Error error) const {
  if (error.code != Errc::sdo_abort) return error;
  const auto others = other_axes(*session_, profile_, node_);
  if (others.empty()) return error;
  return drive_error(Errc::refused, node_,
                     message("it has no axis 1 ({}), which servoctl commands: {}",
                             to_string(objects::kStatusword), others.front().text()),
                     "servoctl cannot command another axis yet; `read` and `write` reach its objects");
}

Result<void> Motion::find_watchdog() {
  if (watchdog_found_) return {};
  auto plan = plan_watchdog(*session_, *profile_, node_, options_.producer,
                            options_.rehearsal ? Listening::so_far : Listening::full);
  if (!plan) return fail(plan.error());
  watchdog_ = std::move(*plan);
  watchdog_found_ = true;
  return {};
}

show::OwedRestart Motion::owed() const { return show::owed_restart(*session_, options_.state_folder, node_); }

Result<std::vector<PreflightItem>> Motion::look(bool chinese) {
  auto items = look_at_drive(chinese);
  if (!items) return items;
  chinese_ = chinese;
  shown_ = *items;
  // What refuses the motion needs no second of listening.
  if (check_preflight(*items, node_)) {
    if (const auto found = find_watchdog(); !found) return fail(found.error());
    items->push_back(watchdog_item(watchdog_));
  }
  if (const auto other = units_->other_turn())
    items->push_back(
        {PreflightItem::Weight::caution, "turn",
         formatted("it was told to be {} increments (--turn or the cabinet file), and the drive's parameters "
                   "make it {}: where they are right, speeds and ways are {} times what is asked for",
                   plain_number(*units_->turn(), 12), plain_number(*other, 12),
                   number_text(*units_->turn() / *other))});
  if (units_->is_unproven(objects::kTargetVelocity))
    items->push_back({PreflightItem::Weight::caution, "units",
                      "nothing states the unit of speeds (60A9h, the drive's data): plain numbers go to the "
                      "drive as they are, and no limit in rpm holds"});
  else if (speed_cap_ && options_.speed_limit.empty() && supposed_turn_ && !limited_by_monitor_)
    items->push_back({PreflightItem::Weight::caution, "speed", unconverted_limit()});
  return items;
}

void Motion::set_standstill(double speed) {
  const bool rpm = units_->unit(objects::kVelocityActual) == "rpm";
  standstill_ = std::max(rpm ? kNoiseRpm : 0, std::abs(speed) * kNoisePart);
  if (guard_) guard_->set_standstill(standstill_);
  monitor_->set_noise(standstill_);
}

bool Motion::stands_still(const MotionSample& sample) const {
  if (sample.is_cut_short) return false;
  const auto speed = sample[Signal::velocity];
  const auto by_position = monitor_->least_by_position();
  return (!speed || std::abs(*speed) <= standstill_) && (!by_position || *by_position <= standstill_);
}

bool Motion::supervise_speed(double limit) {
  if (units_->unit(objects::kVelocityActual) != units_->unit(objects::kTargetVelocity)) return false;
  monitor_->limits().speed = limit;
  if (units_->unit(objects::kTargetVelocity) == "rpm") told_rpm_ = std::abs(limit);
  return true;
}

void Motion::supervise_overspeed(double speed) {
  (void)supervise_speed(std::abs(speed) * kOverspeed + standstill_ * kNoiseOfOverspeed);
  if (told_rpm_) told_rpm_ = std::abs(speed);
}

bool Motion::add_setting(ObjectAddress object, double value, MotionPlan& plan) const {
  const auto data = units_->bytes(object, value);
  if (!data) return false;
  plan.settings.emplace_back(object, *data);
  const auto held = units_->physical(object, *data);
  if (held && std::abs(held->value - value) > std::abs(value) * kChosenLoss)
    plan.notes.push_back(formatted("{} is set to {} {}, the nearest possible value to {}", to_string(object),
                                   number_text(held->value), held->unit, number_text(value)));
  return true;
}

Result<void> Motion::add_ramps(double speed, std::initializer_list<ObjectAddress> objects,
                               MotionPlan& plan) const {
  for (const auto object : objects) {
    if (!units_->has(object)) continue;
    if (!options_.acceleration.empty()) {
      const auto asked = units_->parse(object, options_.acceleration, MotionUnits::Kind::size);
      if (!asked) return fail(asked.error());
      plan.settings.emplace_back(object, asked->data);
      plan.tell(asked->rounding);
      continue;
    }
    const auto ramp =
        drive::soft_ramp(units_->unit(object), units_->unit(objects::kTargetVelocity), speed, kRampSeconds);
    if (ramp) (void)add_setting(object, *ramp, plan);
  }
  return {};
}

std::optional<Duration> Motion::duration(double way, double speed) const {
  const auto one = rate();
  if (!one || speed == 0) return std::nullopt;
  const double seconds = std::min(std::abs(way / (speed * *one)) + 2 * kRampSeconds, kLongest);
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
}

Result<void> Motion::look_again() {
  // Answers to other masters that came meanwhile must not be taken for answers to what is asked now.
  if (const auto heard = session_->listen(); !heard) return heard;
  const auto state = power_.state();
  if (!state) return fail(state.error());
  if (drive::is_energised(*state)) return fail(enabled_by_others(node_, *state));
  return {};
}

Result<void> Motion::begin(std::int8_t mode, const std::vector<MotionSetting>& settings,
                           std::optional<ObjectAddress> kept_target) {
  if (const auto found = find_watchdog(); !found) return found;
  if (const auto ready = look_again(); !ready) return ready;
  if (const auto own = claim_producer(*session_, node_, options_.producer, watchdog_); !own) return own;
  monitor_->find_tpdos();
  guard_.reset();  // Its way out comes before the next one begins.
  guard_ = std::make_unique<MotionGuard>(*session_, *units_, node_);
  guard_->set_standstill(standstill_);
  guard_->set_other_source(source_);
  session::Rehearsal unused;
  if (const auto ready = make_ready(*guard_, mode, settings, kept_target, unused); !ready) return ready;
  if (const auto fine = look_in_op(); !fine) return fine;
  (void)session_->take_events();  // What was told before is no news of this motion.
  monitor_->expect_mode(mode);
  auto enabled = guard_->enable();
  monitor_->on_written();
  return enabled;
}

Result<void> Motion::look_in_op() {
  if (!guard_->needs_process_data()) return {};
  return motion::look_in_op(*session_, *units_, node_, chinese_, shown_, options_.ask_again, request());
}

/// All that is done before it is enabled.
Result<void> Motion::make_ready(MotionGuard& guard, std::int8_t mode,
                                const std::vector<MotionSetting>& settings,
                                std::optional<ObjectAddress> kept_target, session::Rehearsal& rehearsal) {
  if (const auto done = guard.learn_rpdos(); !done) return done;
  rehearsal.begin_step("memory");
  if (const auto done = guard.spare_flash(); !done) return done;
  rehearsal.begin_step("watchdog");
  if (const auto done = guard.arm(watchdog_); !done) return done;
  const bool starts_first = guard.needs_process_data();
  rehearsal.begin_step("start");
  if (starts_first)
    if (const auto done = guard.start_node(); !done) return done;
  rehearsal.begin_step("mode");
  if (const auto done = guard.change_mode(mode); !done) return done;
  rehearsal.begin_step("target");
  if (const auto done = guard.neutral_targets(kept_target); !done) return done;
  rehearsal.begin_step("setting");
  for (const auto& [object, data] : settings)
    if (const auto done = guard.change(object, data); !done) return done;
  rehearsal.begin_step("start");
  return starts_first ? Result<void>() : guard.start_node();
}

Result<std::vector<session::PlannedMessage>> Motion::rehearse(const MotionPlan& plan) {
  if (const auto found = find_watchdog(); !found) return fail(found.error());
  if (const auto ready = look_again(); !ready) return fail(ready.error());
  session::Rehearsal out;
  MotionGuard guard(*session_, *units_, node_);
  guard.rehearse(out);
  if (const auto ready = make_ready(guard, plan.mode, plan.settings, plan.kept_target, out); !ready)
    return fail(ready.error());
  out.begin_step("enable");
  if (const auto enabled = guard.enable(); !enabled) return fail(enabled.error());
  out.begin_step("motion");
  for (const auto& [object, data] : plan.moving) {
    if (object == objects::kControlword)
      out.add(session::planned_write({node_, object, data}));
    else if (const auto done = guard.change(object, data); !done)
      return fail(done.error());
  }
  (void)guard.end();
  return out.messages();
}

Result<void> Motion::write(ObjectAddress object, const Bytes& data) {
  const session::Hurry hurry(*session_, kMovingPatience, 1);
  auto done = guard_->change(object, data);
  // The late answer to a read that the time cut short may have come first.
  if (!done && done.error().code == Errc::protocol) done = guard_->change(object, data);
  monitor_->on_written();
  return done;
}

Result<void> Motion::command(std::uint16_t controlword) {
  auto done = power_.command(controlword);
  monitor_->on_written();
  return done;
}

MotionReport Motion::finish(Result<void> outcome) {
  MotionReport out;
  out.outcome = std::move(outcome);
  out.watchdog = watchdog_;
  out.begun = guard_ != nullptr;
  if (guard_) out.end = guard_->end();
  const bool fault =
      out.end.state == drive::DriveState::fault || out.end.state == drive::DriveState::fault_reaction_active;
  if (out.outcome && out.begun && fault)
    out.outcome =
        fail(error(Errc::negative,
                   message("went to fault while it was stopped (statusword 0x{:04X})", out.end.statusword),
                   "`fault show` shows the fault"));
  try {
    out.samples = monitor_->samples();
    out.series = monitor_->series();
  } catch (const std::bad_alloc&) {
    out.samples.clear();
    out.series.clear();
    if (out.outcome) out.outcome = fail(error(Errc::bug, "out of memory: there are no samples to show"));
  }
  out.events = monitor_->events();
  out.by_pdo = monitor_->by_pdo();
  if (!turn_unchecked_.empty()) out.unchecked.push_back(turn_unchecked_);
  return out;
}

}  // namespace servoctl::motion
