#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "drive/cia402.hpp"

namespace servoctl::drive {

/// One step from a power state to its neighbour.
struct PowerStep {
  std::optional<std::uint16_t> controlword;  ///< Empty: the drive makes this step by itself.
  DriveState reached;                        ///< What the statusword has to say before the next step.

  bool operator==(const PowerStep&) const = default;
};

/// The shortest legal way between two power states (CiA 402-2, 8.2.3), one transition a step: switch on and
/// enable operation are never made in one, because not every drive follows that. Empty list: already there;
/// nothing: there is no way. A fault is left by a reset only, which is asked for separately, and no command
/// leads into a fault. `resumes` says whether this drive goes from "quick stop active" back to "operation
/// enabled" (transition 16).
std::optional<std::vector<PowerStep>> power_path(DriveState from, DriveState to, bool resumes);

}  // namespace servoctl::drive
