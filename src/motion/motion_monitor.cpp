#include "motion/motion_monitor.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

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

tl::unexpected<Error> stopped_by(std::uint8_t node, const std::string& what, std::string hint) {
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
}

void MotionMonitor::find_tpdos() {
  if (tpdos_) return;
  std::vector<ObjectAddress> objects{objects::kStatusword};
  for (const auto signal : channels_) objects.push_back(object_of(signal));
  mapping_.emplace(*session_, node_);
  tpdos_ = session::process_values(*session_, &units_->profile(), node_, objects);
  // The session learns from it under which CAN-ID emergencies come.
  if (units_->has(objects::kEmergencyCobId)) (void)session_->upload(node_, objects::kEmergencyCobId);
}

void MotionMonitor::tell_end_of_tpdos() {
  const auto why = mapping_ ? mapping_->ended() : std::string();
  if (why.empty()) return;
  mapping_.reset();
  if (by_pdo_ > 0 && session_->options().tell)
    session_->options().tell(fmt::format("node {} {}: its values are read by SDO from now on", node_, why));
}

std::vector<Result<Bytes>> MotionMonitor::look(std::span<const ObjectAddress> objects) {
  tell_end_of_tpdos();
  const auto since = std::max(told_at_, session_->now() - kPeriod);
  std::vector<Result<Bytes>> out;
  std::vector<session::SdoRequest> requests;
  for (const auto object : objects) {
    auto brought = tpdos_ ? tpdos_->take(object, since) : std::nullopt;
    if (brought)
      ++by_pdo_;
    else
      requests.push_back({.node = node_, .object = object, .size = object == objects::kStatusword ? 2U : 0U});
    out.emplace_back(brought ? std::move(*brought) : Bytes{});
  }
  const session::Hurry hurry(*session_, kMovingPatience, 1);
  const auto answers = session_->transfer(requests);
  for (std::size_t i = 0, asked = 0; i < objects.size() && asked < requests.size(); ++i)
    if (requests[asked].object == objects[i]) out[i] = answers[asked++];
  return out;
}

Result<MotionSample> MotionMonitor::sample() {
  std::vector<ObjectAddress> wanted{objects::kStatusword};
  for (const auto signal : channels_) wanted.push_back(object_of(signal));
  const auto answers = look(wanted);
  if (!answers[0]) return fail(answers[0].error());
  MotionSample out;
  out.time = session_->now();
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
  if (!begin_) begin_ = out[Signal::position];
  if (rate_ && !samples_.empty()) follow_zero(out);
  samples_.push_back(out);
  for (const auto& done : {session::refuse_duplicate(*session_, node_), check_producer(*session_),
                           check_events(), check_state(out), check_limits(out)})
    if (!done) return fail(done.error());
  return out;
}

void MotionMonitor::follow_zero(const MotionSample& sample) {
  const auto& last = samples_.back();
  const auto here = sample[Signal::position];
  const auto there = last[Signal::position];
  const auto speed = sample[Signal::velocity];
  if (!here || !there || !speed) return;
  const double seconds = std::chrono::duration<double>(sample.time - last.time).count();
  const double fastest = std::max(std::abs(*speed), std::abs(last[Signal::velocity].value_or(0)));
  const double longest = fastest * *rate_ * seconds * kUnevenness + *rate_;
  if (std::abs(*here - *there) > longest) begin_ = *begin_ + *here - *there;
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
      const bool message = !faults.empty() && faults.front()->kind == drive::Fault::Kind::status;
      if (told->code != 0 && !message)
        out = stopped_by(node_, fmt::format("sent emergency 0x{:04X} while moving", told->code),
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
                    fmt::format("left \"operation enabled\" while moving: {} (statusword 0x{:04X})",
                                drive::name(state), sample.statusword),
                    "see `fault show`; an input, another master or the panel may have disabled it");
}

Result<void> MotionMonitor::check_limits(const MotionSample& sample) const {
  const auto beyond = [&](Signal signal, std::optional<double> limit, double from, std::string_view what) {
    const auto value = sample[signal];
    if (!limit || !value || std::abs(*value - from) <= *limit) return Result<void>{};
    const auto numbers = told_apart(*value - from, *limit);
    return Result<void>(stopped_by(node_,
                                   fmt::format("{} of {} {} exceeds its limit of {}", what, numbers.first,
                                               units_->unit(object_of(signal)), numbers.second),
                                   "raise the limit, if this is intended"));
  };
  for (const auto& done : {beyond(Signal::torque, limits_.torque, 0, "the torque"),
                           beyond(Signal::following_error, limits_.following_error, 0, "the following error"),
                           beyond(Signal::position, limits_.travel, begin_.value_or(0), "the way"),
                           beyond(Signal::velocity, limits_.speed, 0, "the speed")})
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
