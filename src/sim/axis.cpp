#include "sim/axis.hpp"

#include <algorithm>
#include <cmath>

#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::sim {
namespace {

constexpr double kTick = 0.001;
constexpr std::uint16_t kNewSetpoint = 1U << 4U;
constexpr std::uint16_t kAtOnce = 1U << 5U;
constexpr std::uint16_t kRelative = 1U << 6U;
constexpr std::uint16_t kHalt = 1U << 8U;

/// CiA 402-2, 6060h.
constexpr std::int8_t kInterpolatedMode = 7;
constexpr std::int8_t kCyclicPositionMode = 8;
constexpr std::int8_t kCyclicVelocityMode = 9;
constexpr std::int8_t kCyclicTorqueMode = 10;

}  // namespace

void Axis::reset(TimePoint now) {
  const auto faults = faults_;
  const auto track = track_;
  const auto own_counts = own_counts_;
  const auto panel = panel_;
  *this = Axis(*profile_, *values_);
  panel_ = panel;
  own_counts_ = own_counts;
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
  if (mode == kInterpolatedMode) return Kind::interpolated;
  if (mode == kCyclicVelocityMode) return Kind::cyclic_velocity;
  if (mode == kCyclicTorqueMode) return Kind::cyclic_torque;
  return mode == kCyclicPositionMode ? Kind::cyclic : Kind::none;
}

bool Axis::controls_position() const {
  const auto now = kind();
  return now == Kind::position || now == Kind::homing || now == Kind::interpolated || now == Kind::cyclic;
}

bool Axis::is_active() const { return (controlword_ & kNewSetpoint) != 0; }
bool Axis::is_halted() const { return profile_->rules.motion.halt && (controlword_ & kHalt) != 0; }

void Axis::on_controlword(std::uint16_t controlword, Drive drive, TimePoint now) {
  advance(drive, now);
  look_at_switch_rules();
  const bool rising = (controlword & kNewSetpoint) != 0 && (controlword_ & kNewSetpoint) == 0;
  const bool low = (controlword & kNewSetpoint) == 0;
  controlword_ = controlword;
  if (drive != Drive::obeying || low) point_.reset();
  if (drive != Drive::obeying) {
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
  const auto& like = profile_->rules.motion.homing_like;
  const auto other = like.find(method);
  homing_.start(other != like.end() ? other->second : method, {seek, zero > 0 ? zero : seek},
                time_ + faults_.late_start);
}

/// One step on the way home, and what that brings.
void Axis::home(double seconds) {
  approach(is_halted() ? 0 : homing_.speed(), seconds);
  travel(seconds);
  const auto found = homing_.look(track_, place(), velocity_ == 0, time_);
  if (!found) return;
  const double here = origin_ + *found * units_per_turn();
  position_ = read(objects::kHomeOffset);
  origin_ += position_ - here;
  velocity_ = 0;
  homed_ = true;
}

/// Whether nothing is left to be done step by step.
bool Axis::has_settled() const {
  switch (drive_) {
    case Drive::released: return true;
    case Drive::stopping: return velocity_ == 0;
    case Drive::obeying: return is_steady() && !homing_.is_running();
  }
  return true;
}

void Axis::advance(Drive drive, TimePoint now) {
  drive_ = drive;
  if (drive == Drive::released) {
    velocity_ = 0;
    torque_ = 0;
    behind_ = 0;
    out_since_.reset();
  }
  for (; time_ + std::chrono::milliseconds(1) <= now; time_ += std::chrono::milliseconds(1)) {
    if (drive == Drive::obeying) follow();
    if (kind() != Kind::homing) homing_.stop();
    if (has_settled()) {
      const bool pushes = kind() == Kind::torque || kind() == Kind::cyclic_torque;
      if (!pushes || drive == Drive::stopping) torque_ = 0;
      travel(std::chrono::duration<double>(now - time_).count());
      time_ = now;
      break;
    }
    step(kTick);
    watch_window();
  }
  publish();
}

}  // namespace servoctl::sim
