#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "motion/held_cautions.hpp"
#include "motion/motion_units.hpp"

namespace servoctl::motion {

/// A parameter that keeps a drive from taking commands from this bus (`[nmt] needs` of the family's data).
struct OtherSource {
  std::string name;
  double in_force = 0;      ///< Where it does not wait.
  std::int64_t needed = 0;  ///< What it has to be.
  bool waits = false;       ///< It is set to that, and waits for a restart.

  /// "P0.03 is 0, and 7 is needed for CANopen", "P0.03 = 7 waits for a restart".
  std::string cause() const;
  /// "`param set P0.03=7 -n 1` and restart the drive".
  std::string remedy(const drive::Profile& profile, std::uint8_t node) const;
};

/// The first of them, judged by the values in force: where one waits for a restart, the value before it. Only
/// reads. Errors are those of the transfers; a parameter that the drive refuses to give says nothing.
Result<std::optional<OtherSource>> other_source(session::Session& session, const MotionUnits& units,
                                                const OwedValues& owed);

/// The line that sets a parameter so that it is still set after a restart:
/// "param set Fn_00=20 -n 1 --unlock --keep".
std::string lasting_setting(const drive::Profile& profile, std::uint8_t node, std::string_view name,
                            std::int64_t value);

}  // namespace servoctl::motion
