#pragma once

#include <cstdint>

#include "base/time.hpp"
#include "drive/cia402.hpp"
#include "drive/rules.hpp"

namespace servoctl::sim {

/// The CiA 402 state machine of a simulated drive: controlwords in, statuswords out, in the numbers the
/// family's manual prints. Quick stop and fault reaction take 20 ms, or as long as their ramp.
class PowerStage {
 public:
  explicit PowerStage(const drive::Rules& rules) : rules_(&rules) {}

  /// Power-on: straight to "switch on disabled".
  void reset();
  /// `quick_stop_option` is 605Ah, `may_reset` whether the family allows a fault to be reset now.
  void on_controlword(std::uint16_t controlword, std::int64_t quick_stop_option, bool may_reset,
                      TimePoint now);
  void raise_fault(TimePoint now);
  /// The quick stop or fault reaction that has begun ends no earlier than this.
  void stop_until(TimePoint end);
  /// Resets a fault by other means than the controlword; false when there is none.
  bool reset_fault();
  /// De-energises at once, whatever the state; a fault stays.
  void disable();
  /// The enable input (STO) takes the power away, whatever is commanded. When it is given back, a controlword
  /// that still says "enable operation" energises again: what some drives do.
  void set_torque_off(bool off);
  void on_time(TimePoint now);
  TimePoint deadline() const { return deadline_; }

  drive::DriveState state() const { return state_; }
  std::uint16_t statusword(std::int8_t mode) const;
  /// Whether the last controlword took the drive out of "fault".
  bool was_reset() const { return was_reset_; }

 private:
  const drive::Rules* rules_;
  drive::DriveState state_ = drive::DriveState::not_ready_to_switch_on;
  std::uint16_t controlword_ = 0;
  bool stays_enabled_ = false;
  bool was_reset_ = false;
  bool torque_off_ = false;
  TimePoint deadline_ = kNever;
};

}  // namespace servoctl::sim
