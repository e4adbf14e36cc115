#pragma once

#include "motion/motion_kinds.hpp"

namespace servoctl::motion {

/// The drive's own monitor of the motor's speed, beside which a turn is measured.
class SpeedMonitor {
 public:
  /// Both outlive it.
  SpeedMonitor(Motion& motion, const Learn& learn);

  /// What it shows goes in steps of so many rpm.
  double step() const { return step_; }
  /// rpm, with the patience for a motor that turns. Errors as Session::upload().
  Result<double> read();
  /// Before anything turns: it can be read, and shows standstill. Errc::refused when not.
  Result<void> check_still();

 private:
  double rpm_of(const Bytes& data) const;

  Motion* motion_;
  const Learn* learn_;
  double step_ = 0;
};

}  // namespace servoctl::motion
