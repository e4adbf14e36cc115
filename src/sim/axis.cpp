#include "sim/axis.hpp"

#include <algorithm>
#include <cmath>

#include "drive/quantity.hpp"
#include "sim/known_objects.hpp"

namespace servoctl::sim {
namespace {

constexpr double kTick = 0.001;
constexpr double kPi = 3.14159265358979323846;
/// Where the manual does not tell the counts of a turn.
constexpr double kAssumedTurn = 10000;
/// Speed that ramps given as a time lead to.
constexpr double kRampSpeedRpm = 3000;
constexpr double kNoRamp = 1e12;
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

constexpr ObjectAddress kPositionActual{0x6064, 0};
constexpr ObjectAddress kVelocityActual{0x606C, 0};
constexpr ObjectAddress kTargetTorque{0x6071, 0};
constexpr ObjectAddress kTorqueActual{0x6077, 0};
constexpr ObjectAddress kTargetPosition{0x607A, 0};
constexpr ObjectAddress kHomeOffset{0x607C, 0};
constexpr ObjectAddress kProfileVelocity{0x6081, 0};
constexpr ObjectAddress kAcceleration{0x6083, 0};
constexpr ObjectAddress kTargetVelocity{0x60FF, 0};
constexpr ObjectAddress kHomingMethod{0x6098, 0};

constexpr std::int8_t kInterpolatedMode = 7;  ///< CiA 402-2.

}  // namespace

void Axis::reset(TimePoint now) {
  *this = Axis(*profile_, *values_);
  time_ = now;
}

Axis::Kind Axis::kind() const {
  const auto mode = static_cast<std::int8_t>(values_->number(kModeDisplay));
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
  if (kind() == Kind::position) {
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
  const double to = read(kTargetPosition) + (relative ? from : 0);
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
  const auto method = static_cast<std::int8_t>(values_->number(kHomingMethod));
  if (std::find(nothing.begin(), nothing.end(), method) != nothing.end()) return;
  homed_ = false;
  homing_ends_ = now + kHomingTime;
}

void Axis::advance(bool enabled, TimePoint now) {
  if (!enabled) {
    velocity_ = 0;
    torque_ = 0;
  }
  for (; time_ + std::chrono::milliseconds(1) <= now; time_ += std::chrono::milliseconds(1)) {
    if (!enabled || (is_steady() && !homing_ends_)) {
      position_ += velocity_ * std::chrono::duration<double>(now - time_).count();
      time_ = now;
      break;
    }
    step(kTick);
    if (homing_ends_ && time_ >= *homing_ends_) {
      homing_ends_.reset();
      homed_ = true;
      position_ = read(kHomeOffset);
    }
  }
  publish();
}

/// Whether nothing changes but the position, and that evenly.
bool Axis::is_steady() const {
  const bool halted = profile_->rules.motion.halt && (controlword_ & kHalt) != 0;
  switch (kind()) {
    case Kind::velocity: return !halted && velocity_ == read(kTargetVelocity) * speed_factor(kTargetVelocity);
    case Kind::torque: return torque_ == 0 && read(kTargetTorque) == 0;
    default: return velocity_ == 0 && !target_;
  }
}

void Axis::step(double seconds) {
  const bool halted = profile_->rules.motion.halt && (controlword_ & kHalt) != 0;
  switch (kind()) {
    case Kind::position: halted ? approach(0, seconds) : step_position(seconds); break;
    case Kind::velocity:
      approach(halted ? 0 : read(kTargetVelocity) * speed_factor(kTargetVelocity), seconds);
      break;
    case Kind::torque:
      torque_ = halted ? 0 : read(kTargetTorque);
      velocity_ += torque_ / 100 * kTurnsPerSecondOfRatedTorque * units_per_turn() * seconds;
      break;
    case Kind::homing:
    case Kind::interpolated:
    case Kind::none: approach(0, seconds); break;
  }
  position_ += velocity_ * seconds;
}

void Axis::approach(double wanted, double seconds) {
  const double most = ramp(kAcceleration) * seconds;
  velocity_ += std::clamp(wanted - velocity_, -most, most);
}

void Axis::step_position(double seconds) {
  if (!target_) return approach(0, seconds);
  const double left = *target_ - position_;
  const double ramp_rate = ramp(kAcceleration);
  const double braking = std::sqrt(2 * ramp_rate * std::abs(left));
  const double fastest = std::min(std::abs(read(kProfileVelocity) * speed_factor(kProfileVelocity)), braking);
  approach(std::copysign(fastest, left), seconds);
  const bool there = std::abs(left) <= std::abs(velocity_) * seconds + ramp_rate * seconds * seconds;
  if (!there) return;
  position_ = *target_;
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
  if (homing_ends_) return static_cast<std::uint16_t>(~done & kModeBit);
  if (homed_) return static_cast<std::uint16_t>(done | kTargetReached);
  return kTargetReached;
}

std::uint16_t Axis::bits(bool enabled) const {
  const auto lasting = homed_ && profile_->rules.motion.homed_bit ? kHomed : std::uint16_t{0};
  if (!enabled && !(homed_ && kind() == Kind::homing)) return lasting;
  const auto of_mode = [&]() -> std::uint16_t {
    switch (kind()) {
      case Kind::position: return position_bits();
      case Kind::velocity: {
        const bool reached = velocity_ == read(kTargetVelocity) * speed_factor(kTargetVelocity);
        return static_cast<std::uint16_t>((reached ? kTargetReached : 0U) | (velocity_ == 0 ? kModeBit : 0U));
      }
      case Kind::torque: return torque_ == read(kTargetTorque) ? kTargetReached : std::uint16_t{0};
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
  write(kPositionActual, position_);
  write(kVelocityActual, velocity_ / speed_factor(kVelocityActual));
  write(kTorqueActual, torque_);
}

double Axis::read(ObjectAddress object) const {
  const auto meaning = drive::meaning(drive::target_at(profile_, object), 0);
  if (!meaning.type_known) return 0;
  const auto value = od::decode(meaning.type, values_->get(object));
  return value ? drive::scaled(meaning, *value) : 0;
}

void Axis::write(ObjectAddress object, double number) {
  const auto meaning = drive::meaning(drive::target_at(profile_, object), 0);
  if (!meaning.type_known) return;
  const auto raw =
      meaning.encoding == od::Encoding::plain
          ? Result<od::Value>(od::Value(static_cast<std::int64_t>(std::llround(number / meaning.scale))))
          : od::encode_number(meaning.encoding, meaning.type, number);
  const auto bytes = raw ? od::encode(meaning.type, *raw) : tl::unexpected<Error>(raw.error());
  if (bytes) values_->set(object, *bytes);
}

double Axis::units_per_turn() const {
  if (drive::meaning(drive::target_at(profile_, kPositionActual), 0).unit == "rad") return 2 * kPi;
  const auto rule = profile_->rules.units.find(drive::Measure::increments_per_turn);
  if (rule == profile_->rules.units.end()) return kAssumedTurn;
  double out = 1;
  const auto factor = [&](const drive::Quotient::Factor& f) {
    const auto* object = std::get_if<ObjectAddress>(&f);
    return object != nullptr ? read(*object) : std::get<double>(f);
  };
  for (const auto& f : rule->second.multiply) out *= factor(f);
  for (const auto& f : rule->second.divide) out /= factor(f);
  return std::isfinite(out) && out > 0 ? out : kAssumedTurn;
}

double Axis::speed_factor(ObjectAddress object) const {
  const auto unit = drive::meaning(drive::target_at(profile_, object), 0).unit;
  return unit == "rpm" ? units_per_turn() / 60 : 1;
}

double Axis::ramp(ObjectAddress object) const {
  const auto unit = drive::meaning(drive::target_at(profile_, object), 0).unit;
  const double value = read(object);
  if (value <= 0) return kNoRamp;
  if (unit == "ms") return kRampSpeedRpm / 60 * units_per_turn() / (value / 1000);
  return unit == "rpm/s" ? value * units_per_turn() / 60 : value;
}

}  // namespace servoctl::sim
