// How a simulated axis moves.
#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/decade.hpp"
#include "drive/naming.hpp"
#include "drive/quantity.hpp"
#include "drive/rules.hpp"
#include "drive/standard_objects.hpp"
#include "sim/axis.hpp"

namespace servoctl::sim {
namespace {

/// Speed that full rated torque gives the unloaded motor in one second.
constexpr double kTurnsPerSecondOfRatedTorque = 10;
constexpr double kPercent = 100;
/// Of the rated torque, for a short time.
constexpr double kFactoryTorque = 3;
/// The window of the following error where there is no 6065h, in turns.
constexpr double kAssumedWindow = 3;
constexpr double kLongestStop = 86'400;    ///< Seconds; a ramp that takes longer never ends.
constexpr double kNoWindow = 0xFFFF'FFFF;  ///< 6065h: not watched (CiA 402-2).

}  // namespace

std::optional<ObjectAddress> Axis::followed() const {
  switch (kind()) {
    case Kind::position:
      return profile_->rules.motion.handshake ? std::nullopt : std::optional(objects::kTargetPosition);
    case Kind::interpolated: return objects::kInterpolationPoint;
    case Kind::cyclic: return objects::kTargetPosition;
    default: return std::nullopt;
  }
}

/// Without set-points the target is followed as it stands, in interpolated position while bit 4 says so.
void Axis::follow() {
  const auto object = followed();
  if (!object) return;
  if (kind() == Kind::interpolated && interpolates_at_sync()) return follow_point();
  const auto [least, greatest] = limits();
  const double target = std::clamp(read(*object), least, greatest);
  target_.reset();
  if (target != position_ && (kind() != Kind::interpolated || is_active())) target_ = target;
}

/// At a point after which none has come the motor stands: it is where it was told to be.
void Axis::follow_point() {
  target_.reset();
  if (!point_ || !is_active()) return;
  const auto [least, greatest] = limits();
  const double target = std::clamp(*point_, least, greatest);
  if (target == position_)
    velocity_ = 0;
  else
    target_ = target;
}

void Axis::take_point() {
  if (kind() != Kind::interpolated || !interpolates_at_sync() || !is_active()) return;
  point_ = read(objects::kInterpolationPoint);
  point_due_ = time_ + interpolation_period();
}

/// 60C2h: value by power of ten, in seconds.
Duration Axis::interpolation_period() const {
  const auto& limits = profile_->rules.motion.interpolation_ms;
  const double ms = read(objects::kInterpolationPeriod) *
                    power_of_ten(static_cast<int>(read(objects::kInterpolationIndex)) + 3);
  const double taken = std::clamp<double>(ms, limits.front(), limits.back());
  return std::chrono::microseconds(std::llround(taken * 1000));
}

/// What 607Dh leaves, where it acts. Limits that leave nothing are none.
Axis::Range Axis::limits() const {
  constexpr Range kAll{-Track::kFar, Track::kFar};
  const auto& motion = profile_->rules.motion;
  const auto& gate = motion.software_limits;
  if (gate && load_le(values_->in_force(gate->object)) != gate->value) return kAll;
  if (motion.software_limits_homed && !homed_) return kAll;
  const Range out{read(objects::kLowerPositionLimit), read(objects::kUpperPositionLimit)};
  return out.least < out.greatest ? out : kAll;
}

bool Axis::is_at_limit() const {
  const auto [least, greatest] = limits();
  const auto pressed = [&](Input input) { return track_.stops(input) && track_.is_pressed(input, place()); };
  return position_ <= least || position_ >= greatest || pressed(Input::negative_limit) ||
         pressed(Input::positive_limit);
}

/// What the limits leave of a speed: from it the axis must come to rest before them.
double Axis::allowed(double wanted) const {
  if (wanted == 0 || kind() == Kind::homing) return wanted;
  const int direction = wanted > 0 ? 1 : -1;
  if (const auto limit = Track::limit(direction); track_.stops(limit) && track_.is_pressed(limit, place()))
    return 0;
  const auto [least, greatest] = limits();
  const double left = direction > 0 ? greatest - position_ : position_ - least;
  const double braking = left > 0 ? std::sqrt(2 * ramp() * left) : 0;
  return std::copysign(std::min(std::abs(wanted), braking), wanted);
}

/// The position by the present speed; what is in the way keeps it from following.
void Axis::travel(double seconds) {
  const double way = velocity_ * seconds;
  if (faults_.stalled)
    behind_ += way;
  else
    position_ += faults_.reversed ? -way : way;
}

void Axis::watch_window() {
  const double window = profile_->dictionary.find(objects::kFollowingErrorWindow) != nullptr
                            ? read(objects::kFollowingErrorWindow)
                            : kAssumedWindow * units_per_turn();
  const bool watched = controls_position() && window > 0 && window < kNoWindow;
  if (!watched || std::abs(behind_) <= window) return out_since_.reset();
  if (!out_since_) out_since_ = time_;
  const auto patience = std::chrono::milliseconds(values_->number(objects::kFollowingErrorTime));
  following_error_ = following_error_ || time_ - *out_since_ >= patience;
}

/// Whether nothing changes but the position, and that evenly.
bool Axis::is_steady() const {
  const auto wanted = [&] { return read(objects::kTargetVelocity) * speed_factor(objects::kTargetVelocity); };
  const auto [least, greatest] = limits();
  const bool free = std::isinf(least) && std::isinf(greatest) && !track_.stops(Input::negative_limit) &&
                    !track_.stops(Input::positive_limit);
  switch (kind()) {
    case Kind::velocity:
    case Kind::cyclic_velocity:
      return velocity_ == 0 ? wanted() == 0 || is_halted() : free && !is_halted() && velocity_ == wanted();
    case Kind::torque:
    case Kind::cyclic_torque: return torque_ == 0 && read(objects::kTargetTorque) == 0;
    default: return velocity_ == 0 && !target_;
  }
}

void Axis::step(double seconds) {
  if (drive_ == Drive::obeying && kind() == Kind::homing) return home(seconds);
  if (drive_ == Drive::obeying && kind() == Kind::interpolated && interpolates_at_sync() && target_ &&
      !is_halted())
    return step_to_point(seconds);
  drive_ == Drive::obeying ? obey(seconds) : approach(0, seconds);
  const auto [least, greatest] = limits();
  const bool inside = position_ >= least && position_ <= greatest;
  travel(seconds);
  if (!inside || (position_ >= least && position_ <= greatest)) return;
  position_ = std::clamp(position_, least, greatest);
  velocity_ = 0;
}

/// The speed that the target of the mode leads to.
void Axis::obey(double seconds) {
  switch (kind()) {
    case Kind::position:
    case Kind::interpolated:
    case Kind::cyclic: is_halted() ? approach(0, seconds) : step_position(seconds); break;
    case Kind::velocity:
    case Kind::cyclic_velocity:
      approach(is_halted() ? 0 : read(objects::kTargetVelocity) * speed_factor(objects::kTargetVelocity),
               seconds);
      break;
    case Kind::torque:
    case Kind::cyclic_torque: {
      torque_ = is_halted() ? 0 : read(objects::kTargetTorque);
      velocity_ += torque_ / rated_torque() * kTurnsPerSecondOfRatedTorque * units_per_turn() * seconds;
      velocity_ = allowed(std::clamp(velocity_, -fastest_by_torque(), fastest_by_torque()));
      break;
    }
    case Kind::homing:
    case Kind::none: approach(0, seconds); break;
  }
}

Duration Axis::begin_stop(const std::string& ramp_by) {
  const auto object = drive::place_of(*profile_, ramp_by);
  if (ramp_by == drive::kMostTorque)
    stop_ramp_ = most_torque() / rated_torque() * kTurnsPerSecondOfRatedTorque * units_per_turn();
  else
    stop_ramp_ = object ? ramp(*object) : kNoRamp;
  const double seconds = std::abs(velocity_) / stop_ramp_;
  const std::chrono::duration<double> time(seconds < kLongestStop ? seconds : kLongestStop);
  return std::chrono::ceil<std::chrono::milliseconds>(time) + std::chrono::milliseconds(1);
}

void Axis::approach(double wanted, double seconds) {
  const double most = ramp() * seconds;
  const double change = std::clamp(allowed(wanted) - velocity_, -most, most);
  velocity_ += change;
  show_torque(change / seconds);
}

/// What the motor needs for an acceleration in units a second a second; one that cannot turn pushes with all
/// it has.
void Axis::show_torque(double acceleration) {
  const double share = acceleration / units_per_turn() / kTurnsPerSecondOfRatedTorque;
  const double most = most_torque();
  torque_ =
      std::clamp(faults_.stalled && velocity_ != 0 ? std::copysign(most, velocity_) : share * rated_torque(),
                 -most, most);
}

/// In the unit of 6077h.
double Axis::rated_torque() const {
  const auto object = drive::place_of(*profile_, profile_->rules.motion.rated_torque);
  const double rated = object ? read(*object) : 0;
  return rated > 0 ? rated : kPercent;
}

double Axis::most_torque() const {
  const double limit = read(objects::kMaxTorque);
  const double factory = kFactoryTorque * rated_torque();
  return limit > 0 ? std::min(limit, factory) : factory;
}

/// Evenly to the point, in what is left of the period; the course is the master's, and so are its ramps.
void Axis::step_to_point(double seconds) {
  const double left = *target_ - position_;
  const double time = std::max(std::chrono::duration<double>(point_due_ - time_).count(), seconds);
  velocity_ = allowed(left) == 0 ? 0 : left / time;
  const bool arrives = velocity_ != 0 && time <= seconds && !faults_.stalled && !faults_.reversed;
  if (arrives)
    position_ = *target_;
  else
    travel(seconds);
}

void Axis::step_position(double seconds) {
  if (!target_) return approach(0, seconds);
  const auto [least, greatest] = limits();
  const double target = std::clamp(*target_, least, greatest);
  const double left = target - position_;
  const double ramp_rate = ramp();
  const double braking = std::sqrt(2 * ramp_rate * std::abs(left));
  const auto speed = speed_object();
  const bool profiled = kind() == Kind::position;
  const double fastest = profiled ? std::min(std::abs(read(speed) * speed_factor(speed)), braking) : braking;
  approach(std::copysign(fastest, left), seconds);
  const double last_step = std::abs(velocity_) + std::min(ramp_rate * seconds, fastest);
  const bool there = std::abs(left) <= last_step * seconds;
  if (!there) return;
  if (!faults_.stalled && !faults_.reversed) position_ = target;
  velocity_ = 0;
  target_.reset();
  if (waiting_.empty()) return;
  target_ = waiting_.front();
  waiting_.pop_front();
}

}  // namespace servoctl::sim
