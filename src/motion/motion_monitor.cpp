#include "motion/motion_monitor.hpp"

#include <algorithm>
#include <cmath>

#include "base/format.hpp"
#include "base/number.hpp"
#include "drive/standard_objects.hpp"
#include "motion/power.hpp"
#include "motion/producer_claim.hpp"
#include "session/identify.hpp"
#include "session/option_scope.hpp"

namespace servoctl::motion {
namespace {

/// Between two looks a motor may go so much farther than their speeds say.
constexpr double kUnevenness = 2;
/// So often homing gives the position a new zero at most; more jumps are a motor that 606Ch does not show.
constexpr int kMostZeros = 3;
constexpr Duration kModePeriod = std::chrono::milliseconds(100);
/// A way summed up from speeds may be off by so much.
constexpr double kSummed = 0.95;

tl::unexpected<Error> stopped_by(std::uint8_t node, const Message& what, Message hint) {
  return fail(drive_error(Errc::negative, node, what, std::move(hint)));
}

}  // namespace

std::string_view name(Signal signal) {
  constexpr std::array<std::string_view, kSignals> kNames{"position", "velocity", "torque",
                                                          "following_error"};
  return kNames[static_cast<std::size_t>(signal)];
}

ObjectAddress object_of(Signal signal) {
  constexpr std::array<ObjectAddress, kSignals> kObjects{objects::kPositionActual, objects::kVelocityActual,
                                                         objects::kTorqueActual, objects::kFollowingError};
  return kObjects[static_cast<std::size_t>(signal)];
}

MotionMonitor::MotionMonitor(session::Session& session, const MotionUnits& units, std::uint8_t node)
    : session_(&session), units_(&units), node_(node) {
  for (const auto signal : kEverySignal)
    if (units.has(object_of(signal))) channels_.push_back(signal);
  rate_ = units.rate(objects::kVelocityActual);
  const double count = units.step(objects::kPositionActual);
  const auto bytes = od::size_of(units.meaning(objects::kPositionActual).type).value_or(0);
  span_ = std::ldexp(count, static_cast<int>(8 * bytes));
  speeds_.set_rate(rate_);
  speeds_.set_steps(count, units.step(objects::kVelocityActual));
}

void MotionMonitor::find_tpdos() {
  if (tpdos_) return;
  std::vector<ObjectAddress> objects{objects::kStatusword};
  for (const auto signal : channels_) objects.push_back(object_of(signal));
  mapping_.emplace(*session_, node_);
  if (units_->has(objects::kModeDisplay)) objects.push_back(objects::kModeDisplay);
  tpdos_ = session::process_values(*session_, &units_->profile(), node_, objects);
  // The session learns from it under which CAN-ID emergencies come.
  if (units_->has(objects::kEmergencyCobId)) (void)session_->upload(node_, objects::kEmergencyCobId);
}

void MotionMonitor::tell_end_of_tpdos() {
  const auto why = mapping_ ? mapping_->ended() : std::string();
  if (why.empty()) return;
  mapping_.reset();
  if (by_pdo_ > 0 && session_->options().tell)
    session_->options().tell(formatted("node {} {}: its values are read by SDO from now on", node_, why));
}

std::vector<Result<Bytes>> MotionMonitor::look(std::span<const ObjectAddress> objects, TimePoint end) {
  tell_end_of_tpdos();
  const auto since = std::max(told_at_, session_->now() - kPeriod);
  const session::Hurry hurry(*session_, kMovingPatience, 1);
  std::vector<Result<Bytes>> out;
  std::optional<Error> unanswered;
  for (const auto object : objects) {
    auto brought = tpdos_ ? tpdos_->take(object, since) : std::nullopt;
    if (brought) ++by_pdo_;
    const bool asks = !brought && !unanswered && (out.empty() || session_->now() < end);
    const std::size_t size = object == objects::kStatusword ? 2 : 0;
    const session::SdoRequest request[] = {{.node = node_, .object = object, .size = size}};
    auto answer =
        asks ? std::move(session_->transfer(request).front()) : Result<Bytes>(brought.value_or(Bytes{}));
    if (!answer && answer.error().code != Errc::sdo_abort) unanswered = answer.error();
    out.push_back(unanswered && !brought ? Result<Bytes>(fail(*unanswered)) : std::move(answer));
  }
  return out;
}

bool MotionMonitor::looks_at_mode() const {
  return mode_ && units_->has(objects::kModeDisplay) && session_->now() - mode_looked_at_ >= kModePeriod;
}

Result<MotionSample> MotionMonitor::sample(TimePoint end) {
  std::vector<ObjectAddress> wanted{objects::kStatusword};
  for (const auto signal : channels_) wanted.push_back(object_of(signal));
  const bool with_mode = looks_at_mode();
  if (with_mode) wanted.push_back(objects::kModeDisplay);
  MotionSample out;
  out.begun = session_->now() - (tpdos_ ? kPeriod : Duration::zero());
  const auto answers = look(wanted, end);
  if (!answers[0]) return fail(answers[0].error());
  out.time = session_->now();
  out.is_cut_short = answers.back() && answers.back()->empty();
  out.statusword = static_cast<std::uint16_t>(load_le(*answers[0]));
  std::vector<Signal> known;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const auto& answer = answers[i + 1];
    if (!answer && answer.error().code != Errc::sdo_abort) return fail(answer.error());
    if (!answer) continue;  // The dictionary promises more than the drive has.
    known.push_back(channels_[i]);
    if (const auto number = units_->physical(object_of(channels_[i]), *answer))
      out.values[static_cast<std::size_t>(channels_[i])] = number->value;
  }
  channels_ = std::move(known);
  follow(out);
  const auto seen = check_gap(out);
  samples_.push_back(out);
  for (const auto& done :
       {seen, session::refuse_duplicate(*session_, node_), check_producer(*session_), check_events(),
        check_state(out), with_mode ? check_mode(answers.back()) : Result<void>(), check_limits(out),
        check_speeds()})
    if (!done) return fail(done.error());
  return out;
}

/// The way of the position, and of the speed.
void MotionMonitor::follow(MotionSample& sample) {
  const auto here = sample[Signal::position];
  const auto speed = sample[Signal::velocity];
  const auto since = samples_.empty() ? Duration::zero() : sample.time - samples_.back().time;
  if (speed && rate_) way_by_speed_ += *speed * *rate_ * std::chrono::duration<double>(since).count();
  if (!here) return;
  if (!begin_) begin_ = place_ = *here;
  if (may_jump_ && last_ && follow_zero(sample)) {
    ++zeros_;
    speeds_.forget();
  }
  const double moved = last_ ? *here - *last_ : 0;
  place_ += span_ > 0 ? moved - span_ * std::round(moved / span_) : moved;
  last_ = here;
  speeds_.add(sample.begun, sample.time, place_, speed);
}

std::optional<double> MotionMonitor::way() const {
  return begin_ ? std::optional(place_ - *begin_) : std::nullopt;
}

bool MotionMonitor::follow_zero(const MotionSample& sample) {
  const auto& last = samples_.back();
  const auto speed = sample[Signal::velocity];
  if (!speed || !rate_) return false;
  const double seconds = std::chrono::duration<double>(sample.time - last.time).count();
  const double fastest = std::max(std::abs(*speed), std::abs(last[Signal::velocity].value_or(0)));
  const double longest = fastest * *rate_ * seconds * kUnevenness + *rate_;
  const double jump = *sample[Signal::position] - *last_;
  if (std::abs(jump) <= longest) return false;
  begin_ = *begin_ + jump;
  return true;
}

Result<void> MotionMonitor::check_gap(const MotionSample& sample) const {
  if (samples_.empty() || sample.time - samples_.back().time <= kLongestGap) return {};
  const auto gap = std::chrono::duration<double>(sample.time - samples_.back().time).count();
  return stopped_by(node_, message("was not looked at for {} s while moving", number_text(gap)),
                    "was this program suspended, or is the link slow? A motion needs a look every second");
}

Result<void> MotionMonitor::check_mode(const Result<Bytes>& answer) {
  mode_looked_at_ = session_->now();
  if (!answer) mode_.reset();  // It does not tell it.
  if (!answer || answer->empty() || static_cast<std::int8_t>(load_le(*answer)) == *mode_) return {};
  return stopped_by(node_,
                    message("left its mode while moving: 6061h shows {} instead of {}",
                            static_cast<int>(static_cast<std::int8_t>(load_le(*answer))), int{*mode_}),
                    "another master, or a PDO, may have written 6060h");
}

Result<void> MotionMonitor::check_speeds() const {
  if (zeros_ > kMostZeros)
    return stopped_by(node_, "has a position (6064h) that jumps again and again while homing",
                      "the motor may turn faster than 606Ch shows");
  if (!speeds_.is_contradicted()) return {};
  const auto unit = units_->unit(objects::kVelocityActual);
  const auto by_position = speeds_.shown_by_position();
  if (!by_position)
    return stopped_by(node_,
                      message("reports a speed of {} {} (606Ch), and its position (6064h) stands still or "
                              "goes the other way",
                              number_text(speeds_.shown()), unit),
                      "check the encoder, and polarity (607Eh)");
  return stopped_by(
      node_,
      message("reports a speed of {} {} (606Ch), but its position (6064h) changes by {} {}",
              number_text(speeds_.shown()), unit, number_text(*by_position), unit),
      "one of them is wrong, or their unit: check the encoder, --turn, gear (6091h) and polarity (607Eh)");
}

Result<void> MotionMonitor::wait_for_next() {
  const auto due = samples_.empty() ? session_->now() : samples_.back().time + kPeriod;
  const auto waited = session_->wait([] { return false; }, due);
  if (!waited) return fail(waited.error());
  return {};
}

Result<void> MotionMonitor::check_events() {
  Result<void> out;
  for (const auto& event : session_->take_events()) {
    events_.push_back(event);
    if (event.node != node_ || !out) continue;
    if (const auto* told = std::get_if<canopen::Emergency>(&event.what)) {
      const auto& profile = units_->profile();
      const auto faults = drive::faults_of(profile.faults, profile.rules.emergency, told->code, told->vendor);
      const bool is_status = !faults.empty() && faults.front()->kind == drive::Fault::Kind::status;
      if (told->code != 0 && !is_status)
        out = stopped_by(node_, message("sent emergency 0x{:04X} while moving", told->code),
                         "`fault show` explains it");
    }
    if (std::holds_alternative<session::NodeEvent::BootUp>(event.what))
      out = stopped_by(node_, "restarted while moving",
                       "is its supply steady, or did another node come with its number?");
    if (std::holds_alternative<session::NodeEvent::Gone>(event.what))
      out = fail(drive_error(Errc::timeout, node_, "lost its heartbeat while moving",
                             "check cable, termination and supply"));
  }
  return out;
}

Result<void> MotionMonitor::check_state(const MotionSample& sample) const {
  const auto state = drive::decode_state(sample.statusword);
  if (state == drive::DriveState::operation_enabled) return {};
  return stopped_by(node_,
                    message("left \"operation enabled\" while moving: {} (statusword 0x{:04X})",
                            drive::name(state), sample.statusword),
                    "see `fault show`; an input, another master or the panel may have disabled it");
}

Result<void> MotionMonitor::check_limits(const MotionSample& sample) const {
  const auto beyond = [&](Signal signal, std::optional<double> limit, std::optional<double> value,
                          std::string_view what) {
    if (!limit || !value || std::abs(*value) <= *limit) return Result<void>{};
    const auto numbers = told_apart(*value, *limit);
    return Result<void>(stopped_by(node_,
                                   message("{} of {} {} exceeds its limit of {}", what, numbers.first,
                                           units_->unit(object_of(signal)), numbers.second),
                                   "raise the limit, if this is intended"));
  };
  for (const auto& done :
       {beyond(Signal::torque, limits_.torque, sample[Signal::torque], "the torque"),
        beyond(Signal::following_error, limits_.following_error, sample[Signal::following_error],
               "the following error"),
        beyond(Signal::position, limits_.travel, way(), "the way"),
        beyond(Signal::velocity, limits_.speed, sample[Signal::velocity], "the speed"),
        beyond(Signal::position, limits_.travel, way_by_speed_ * kSummed, "the way by its speed (606Ch)"),
        beyond(Signal::velocity, limits_.speed, speeds_.least_by_position(),
               "the speed by its position (6064h)")})
    if (!done) return done;
  return {};
}

/// The same quantity of the load, where somebody said what that moves.
std::optional<Series> MotionMonitor::of_load(const Series& motor) const {
  const auto unit = units_->of_load(0, motor.unit);
  if (!unit) return std::nullopt;
  Series out{motor.name + " of the load", unit->unit, motor.seconds, {}};
  for (const auto value : motor.values) out.values.push_back(units_->of_load(value, motor.unit)->value);
  return out;
}

std::vector<Series> MotionMonitor::series() const {
  std::vector<Series> out;
  for (const auto signal : kEverySignal) {
    Series one{std::string(name(signal)), units_->unit(object_of(signal)), {}, {}};
    for (const auto& sample : samples_) {
      if (!sample[signal]) continue;
      one.seconds.push_back(std::chrono::duration<double>(sample.time - samples_.front().time).count());
      one.values.push_back(*sample[signal]);
    }
    if (one.values.empty()) continue;
    auto load = of_load(one);
    out.push_back(std::move(one));
    if (load) out.push_back(std::move(*load));
  }
  return out;
}

}  // namespace servoctl::motion
