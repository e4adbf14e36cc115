#include "sim/axis.hpp"

#include <algorithm>
#include <cmath>

#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::sim {
namespace {

constexpr double kTick = 0.001;
/// Speed that full rated torque gives the unloaded motor in one second.
constexpr double kTurnsPerSecondOfRatedTorque = 10;

constexpr std::uint16_t kNewSetpoint = 1U << 4U;
constexpr std::uint16_t kAtOnce = 1U << 5U;
constexpr std::uint16_t kRelative = 1U << 6U;
constexpr std::uint16_t kHalt = 1U << 8U;
constexpr std::uint16_t kTargetReached = 1U << 10U;
constexpr std::uint16_t kModeBit = 1U << 12U;
constexpr std::uint16_t kHomed = 1U << 15U;

constexpr std::int8_t kInterpolatedMode = 7;  ///< CiA 402-2.

}  // namespace

void Axis::reset(TimePoint now) {
  const auto faults = faults_;
  const auto track = track_;
  *this = Axis(*profile_, *values_);
  faults_ = faults;
  track_ = track;
  time_ = now;
}

Axis::Kind Axis::kind() const {
  const auto mode = static_cast<std::int8_t>(values_->number(objects::kModeDisplay));
  const auto& motion = profile_->rules.motion;
  if (mode == 0) return Kind::none;
  if (mode == motion.position) return Kind::position;
  if (mode == motion.velocity) return Kind::velocity;
  if (mode == motion.torque) return Kind::torque;
  if (mode == motion.homing) return Kind::homing;
  return mode == kInterpolatedMode ? Kind::interpolated : Kind::none;
}

void Axis::on_controlword(std::uint16_t controlword, bool enabled, TimePoint now) {
  advance(enabled, now);
  const bool rising = (controlword & kNewSetpoint) != 0 && (controlword_ & kNewSetpoint) == 0;
  const bool low = (controlword & kNewSetpoint) == 0;
  controlword_ = controlword;
  if (!enabled) {
    target_.reset();
    waiting_.clear();
    acknowledged_ = false;
    homing_.stop();
    return;
  }
  if (kind() == Kind::position && profile_->rules.motion.handshake) {
    if (low) acknowledged_ = false;
    if (rising) take_setpoint((controlword & kRelative) != 0, (controlword & kAtOnce) != 0);
  }
  if (kind() == Kind::homing) {
    if (rising) start_homing();
    // Where the start word is followed by one without bit 4, its fall does not end the run.
    const auto& start = profile_->rules.motion.start_homing;
    const bool may_fall = !start.empty() && (start.back() & kNewSetpoint) == 0;
    if (low && !may_fall) homing_.stop();
  }
}

void Axis::take_setpoint(bool relative, bool at_once) {
  if (!at_once && is_full()) return;
  acknowledged_ = true;
  at_once_ = at_once;
  const double from = !waiting_.empty() ? waiting_.back() : target_.value_or(position_);
  const double to = read(objects::kTargetPosition) + (relative ? from : 0);
  if (at_once) waiting_.clear();
  if (at_once || !target_)
    target_ = to;
  else
    waiting_.push_back(to);
}

/// Whether no further set-point fits behind the present one.
bool Axis::is_full() const {
  const auto most = std::max<std::uint32_t>(profile_->rules.motion.setpoints.value_or(1), 1);
  return waiting_.size() + (target_ ? 1U : 0U) >= most;
}

void Axis::start_homing() {
  const auto& nothing = profile_->rules.motion.no_homing;
  const auto method = static_cast<std::int8_t>(values_->number(objects::kHomingMethod));
  if (std::find(nothing.begin(), nothing.end(), method) != nothing.end()) return;
  was_homed_ = homed_;
  homed_ = false;
  const double seek = read(objects::kHomingSpeedSwitch) * speed_factor(objects::kHomingSpeedSwitch);
  const double zero = read(objects::kHomingSpeedZero) * speed_factor(objects::kHomingSpeedZero);
  const double part = ++homings_ % 3 / 2.0;  // 1/2, 1 and 0 in turn.
  track_.shift = track_.scatter * part;
  homing_.start(method, {seek, zero > 0 ? zero : seek}, time_ + faults_.late_start);
}

/// One step on the way home, and what that brings.
void Axis::home(bool halted, double seconds) {
  approach(halted ? 0 : homing_.speed(), seconds);
  travel(seconds);
  const auto found = homing_.look(track_, place(), velocity_ == 0, time_);
  if (!found) return;
  const double here = origin_ + *found * units_per_turn();
  position_ = read(objects::kHomeOffset);
  origin_ += position_ - here;
  velocity_ = 0;
  homed_ = true;
}

void Axis::advance(bool enabled, TimePoint now) {
  if (!enabled) {
    velocity_ = 0;
    torque_ = 0;
    behind_ = 0;
  }
  for (; time_ + std::chrono::milliseconds(1) <= now; time_ += std::chrono::milliseconds(1)) {
    if (enabled) follow_target();
    if (kind() != Kind::homing) homing_.stop();
    if (!enabled || (is_steady() && !homing_.is_running())) {
      travel(std::chrono::duration<double>(now - time_).count());
      time_ = now;
      break;
    }
    step(kTick);
  }
  publish();
}

/// Without a handshake the target is followed as it stands.
void Axis::follow_target() {
  if (kind() != Kind::position || profile_->rules.motion.handshake) return;
  const double target = read(objects::kTargetPosition);
  if (target != position_)
    target_ = target;
  else
    target_.reset();
}

/// The position by the present speed; what is in the way keeps it from following.
void Axis::travel(double seconds) {
  const double way = velocity_ * seconds;
  if (faults_.stalled)
    behind_ += way;
  else
    position_ += faults_.reversed ? -way : way;
}

bool Axis::is_out_of_window() const {
  const double window = read(objects::kFollowingErrorWindow);
  return window > 0 && std::abs(behind_) > window;
}

/// Whether nothing changes but the position, and that evenly.
bool Axis::is_steady() const {
  const bool halted = profile_->rules.motion.halt && (controlword_ & kHalt) != 0;
  switch (kind()) {
    case Kind::velocity:
      return !halted && velocity_ == read(objects::kTargetVelocity) * speed_factor(objects::kTargetVelocity);
    case Kind::torque: return torque_ == 0 && read(objects::kTargetTorque) == 0;
    default: return velocity_ == 0 && !target_;
  }
}

void Axis::step(double seconds) {
  const bool halted = profile_->rules.motion.halt && (controlword_ & kHalt) != 0;
  switch (kind()) {
    case Kind::position: halted ? approach(0, seconds) : step_position(seconds); break;
    case Kind::velocity:
      approach(halted ? 0 : read(objects::kTargetVelocity) * speed_factor(objects::kTargetVelocity), seconds);
      break;
    case Kind::torque:
      torque_ = halted ? 0 : read(objects::kTargetTorque);
      velocity_ += torque_ / 100 * kTurnsPerSecondOfRatedTorque * units_per_turn() * seconds;
      velocity_ = std::clamp(velocity_, -fastest_by_torque(), fastest_by_torque());
      break;
    case Kind::homing: return home(halted, seconds);
    case Kind::interpolated:
    case Kind::none: approach(0, seconds); break;
  }
  travel(seconds);
}

void Axis::approach(double wanted, double seconds) {
  const double most = ramp() * seconds;
  velocity_ += std::clamp(wanted - velocity_, -most, most);
}

void Axis::step_position(double seconds) {
  if (!target_) return approach(0, seconds);
  const double left = *target_ - position_;
  const double ramp_rate = ramp();
  const double braking = std::sqrt(2 * ramp_rate * std::abs(left));
  const auto speed = speed_object();
  const double fastest = std::min(std::abs(read(speed) * speed_factor(speed)), braking);
  approach(std::copysign(fastest, left), seconds);
  const bool there = std::abs(left) <= std::abs(velocity_) * seconds + ramp_rate * seconds * seconds;
  if (!there) return;
  if (!faults_.stalled && !faults_.reversed) position_ = *target_;
  velocity_ = 0;
  target_.reset();
  if (waiting_.empty()) return;
  target_ = waiting_.front();
  waiting_.pop_front();
}

std::uint16_t Axis::position_bits() const {
  const bool busy = acknowledged_ || (is_full() && !at_once_);
  return static_cast<std::uint16_t>((target_ ? 0U : kTargetReached) | (busy ? kModeBit : 0U));
}

std::uint16_t Axis::homing_bits() const {
  const auto& motion = profile_->rules.motion;
  const auto done = static_cast<std::uint16_t>(motion.homing_done & motion.homing_done_mask);
  const bool waits = homing_.is_waiting(time_);
  if (homing_.is_running() && !waits) return static_cast<std::uint16_t>(~done & kModeBit);
  if (homed_ || (waits && was_homed_)) return static_cast<std::uint16_t>(done | kTargetReached);
  const auto at_rest = velocity_ == 0 ? kTargetReached : std::uint16_t{0};
  return static_cast<std::uint16_t>((homing_.has_failed() ? motion.homing_error : 0U) | at_rest);
}

std::uint16_t Axis::bits(bool enabled) const {
  const auto lasting = homed_ && profile_->rules.motion.homed_bit ? kHomed : std::uint16_t{0};
  if (!enabled && !(homed_ && kind() == Kind::homing)) return lasting;
  const auto of_mode = [&]() -> std::uint16_t {
    switch (kind()) {
      case Kind::position: return position_bits();
      case Kind::velocity: {
        const bool reached =
            velocity_ == read(objects::kTargetVelocity) * speed_factor(objects::kTargetVelocity);
        return static_cast<std::uint16_t>((reached ? kTargetReached : 0U) | (velocity_ == 0 ? kModeBit : 0U));
      }
      case Kind::torque: return torque_ == read(objects::kTargetTorque) ? kTargetReached : std::uint16_t{0};
      case Kind::homing: return homing_bits();
      case Kind::interpolated:
        return static_cast<std::uint16_t>(kTargetReached |
                                          ((controlword_ & kNewSetpoint) != 0 ? kModeBit : 0U));
      case Kind::none: return 0;
    }
    return 0;
  }();
  return static_cast<std::uint16_t>(of_mode | lasting);
}

void Axis::publish() {
  write(objects::kPositionActual, position_);
  const double here = place();
  write(objects::kInternalPosition, here * per_turn(drive::Measure::pulses_per_turn));
  std::uint32_t inputs = 0;
  for (const auto input : {Input::negative_limit, Input::positive_limit, Input::home})
    if (track_.is_pressed(input, here))
      inputs |= 1U << profile_->rules.motion.inputs[static_cast<std::size_t>(input)];
  values_->set_number(objects::kDigitalInputs, inputs);
  const double turning = faults_.stalled ? 0 : faults_.reversed ? -velocity_ : velocity_;
  write(objects::kVelocityActual, turning / speed_factor(objects::kVelocityActual));
  write(objects::kTorqueActual, torque_);
  write(objects::kFollowingError, behind_ + turning * faults_.lag);
}

}  // namespace servoctl::sim
