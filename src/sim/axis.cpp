#include "sim/axis.hpp"

#include <algorithm>
#include <cmath>

#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::sim {
namespace {

constexpr double kTick = 0.001;
constexpr Duration kHomingTime = std::chrono::milliseconds(300);
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
  *this = Axis(*profile_, *values_);
  faults_ = faults;
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
    homing_ends_.reset();
    return;
  }
  if (kind() == Kind::position && profile_->rules.motion.handshake) {
    if (low) acknowledged_ = false;
    if (rising) take_setpoint((controlword & kRelative) != 0, (controlword & kAtOnce) != 0);
  }
  if (kind() == Kind::homing) {
    if (rising) start_homing(now);
    // Where the start word is followed by one without bit 4, its fall does not end the run.
    const auto& start = profile_->rules.motion.start_homing;
    const bool may_fall = !start.empty() && (start.back() & kNewSetpoint) == 0;
    if (low && !may_fall) homing_ends_.reset();
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

void Axis::start_homing(TimePoint now) {
  const auto& nothing = profile_->rules.motion.no_homing;
  const auto method = static_cast<std::int8_t>(values_->number(objects::kHomingMethod));
  if (std::find(nothing.begin(), nothing.end(), method) != nothing.end()) return;
  was_homed_ = homed_;
  homed_ = false;
  homing_failed_ = false;
  homing_begins_ = time_ + faults_.late_start;
  homing_moves_ = method != 35 && method != 37;  // They take the present position (CiA 402-2).
  homing_ends_ = faults_.no_index ? kNever : now + faults_.late_start + kHomingTime;
}

void Axis::advance(bool enabled, TimePoint now) {
  if (!enabled) {
    velocity_ = 0;
    torque_ = 0;
    behind_ = 0;
  }
  for (; time_ + std::chrono::milliseconds(1) <= now; time_ += std::chrono::milliseconds(1)) {
    if (enabled) follow_target();
    if (!enabled || (is_steady() && !homing_ends_)) {
      travel(std::chrono::duration<double>(now - time_).count());
      time_ = now;
      break;
    }
    step(kTick);
    if (homing_ends_ && time_ >= *homing_ends_) {
      homing_ends_.reset();
      velocity_ = 0;
      homing_failed_ = faults_.bad_home;
      homed_ = !homing_failed_;
      if (homed_) position_ = read(objects::kHomeOffset);
    }
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
    case Kind::homing:
      approach(homing_ends_ && time_ >= homing_begins_ && !halted && homing_moves_
                   ? read(objects::kHomingSpeedSwitch) * speed_factor(objects::kHomingSpeedSwitch)
                   : 0,
               seconds);
      break;
    case Kind::interpolated:
    case Kind::none: approach(0, seconds); break;
  }
  travel(seconds);
}

void Axis::approach(double wanted, double seconds) {
  const double most = ramp(objects::kProfileAcceleration) * seconds;
  velocity_ += std::clamp(wanted - velocity_, -most, most);
}

void Axis::step_position(double seconds) {
  if (!target_) return approach(0, seconds);
  const double left = *target_ - position_;
  const double ramp_rate = ramp(objects::kProfileAcceleration);
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
  const bool waits = homing_ends_ && time_ < homing_begins_;
  if (homing_ends_ && !waits) return static_cast<std::uint16_t>(~done & kModeBit);
  if (homed_ || (waits && was_homed_)) return static_cast<std::uint16_t>(done | kTargetReached);
  if (homing_failed_) return motion.homing_error;
  return kTargetReached;
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
  const double turning = faults_.stalled ? 0 : faults_.reversed ? -velocity_ : velocity_;
  write(objects::kVelocityActual, turning / speed_factor(objects::kVelocityActual));
  write(objects::kTorqueActual, torque_);
  write(objects::kFollowingError, behind_ + turning * faults_.lag);
}

}  // namespace servoctl::sim
