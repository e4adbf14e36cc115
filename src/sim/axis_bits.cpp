// What a simulated axis says of itself.
#include <algorithm>
#include <cmath>

#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"
#include "sim/axis.hpp"

namespace servoctl::sim {
namespace {

constexpr std::uint16_t kTargetReached = 1U << 10U;
constexpr std::uint16_t kInternalLimit = 1U << 11U;
constexpr std::uint16_t kModeBit = 1U << 12U;
constexpr std::uint16_t kModeError = 1U << 13U;
constexpr std::uint16_t kHomed = 1U << 15U;

}  // namespace

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

/// Bit 13 is the slippage error (CiA 402-2, 60F8h).
std::uint16_t Axis::velocity_bits() const {
  const double wanted = read(objects::kTargetVelocity) * speed_factor(objects::kTargetVelocity);
  const double slippage = std::abs(velocity_ - turning());
  const double most = read(objects::kMaxSlippage) * speed_factor(objects::kMaxSlippage);
  return static_cast<std::uint16_t>((velocity_ == wanted ? kTargetReached : 0U) |
                                    (velocity_ == 0 ? kModeBit : 0U) |
                                    (most > 0 && slippage > most ? kModeError : 0U));
}

/// Where a position is followed: bit 10 is set where the axis stands at what the limits leave of it, bit 11
/// where they leave less than was wanted.
std::uint16_t Axis::following_bits(ObjectAddress target) const {
  const auto [least, greatest] = limits();
  const double wanted = read(target);
  const double left = std::clamp(wanted, least, greatest);
  const bool active = kind() == Kind::cyclic || is_active();
  return static_cast<std::uint16_t>((position_ == left ? kTargetReached : 0U) |
                                    (wanted != left ? kInternalLimit : 0U) | (active ? kModeBit : 0U));
}

std::uint16_t Axis::bits_of_mode() const {
  switch (kind()) {
    case Kind::position: return position_bits();
    case Kind::velocity: return velocity_bits();
    case Kind::torque: return torque_ == read(objects::kTargetTorque) ? kTargetReached : std::uint16_t{0};
    case Kind::homing: return homing_bits();
    case Kind::interpolated:
    case Kind::cyclic: return following_bits(*followed());
    // It follows the target; there is no profile at whose end it could be (CiA 402-2, csv and cst).
    case Kind::cyclic_velocity:
    case Kind::cyclic_torque: return kModeBit;
    case Kind::none: return 0;
  }
  return 0;
}

std::uint16_t Axis::bits(bool enabled) const {
  const bool tells = enabled || (homed_ && kind() == Kind::homing);
  const bool homed = homed_ && profile_->rules.motion.homed_bit;
  return static_cast<std::uint16_t>((tells ? bits_of_mode() : 0U) | (homed ? kHomed : 0U) |
                                    (is_at_limit() ? kInternalLimit : 0U) |
                                    (following_error_ && controls_position() ? kModeError : 0U));
}

double Axis::turning() const { return faults_.stalled ? 0 : faults_.reversed ? -velocity_ : velocity_; }

/// Nearly every read finds an axis that stands: its objects hold all of it already.
void Axis::publish() {
  if (shown_ == shown()) return;
  publish(place());
  shown_ = shown();
}

void Axis::publish(double here) {
  write(objects::kPositionActual, position_);
  write(encoder_, here * per_turn(drive::Measure::pulses_per_turn));
  const auto& motion = profile_->rules.motion;
  std::uint32_t inputs = 0;
  for (const auto bit : motion.inputs_active_low) inputs |= 1U << bit;
  for (const auto input : {Input::negative_limit, Input::positive_limit, Input::home})
    if (track_.is_pressed(input, here)) inputs ^= 1U << motion.inputs[static_cast<std::size_t>(input)];
  values_->set_number(objects::kDigitalInputs, inputs);
  write(objects::kVelocityActual, turning() / speed_factor(objects::kVelocityActual));
  const bool pulses = meaning_of(objects::kVelocitySensor).unit == "pulse/s";
  write(objects::kVelocitySensor,
        pulses ? turning() / units_per_turn() * per_turn(drive::Measure::pulses_per_turn)
               : turning() / speed_factor(objects::kVelocitySensor));
  write(objects::kVelocityDemand, velocity_ / speed_factor(objects::kVelocityDemand));
  if (speed_monitor_) write(*speed_monitor_, turning() / units_per_turn() * 60);
  write(objects::kTorqueActual, torque_);
  write(objects::kFollowingError, behind_ + turning() * faults_.lag);
}

}  // namespace servoctl::sim
