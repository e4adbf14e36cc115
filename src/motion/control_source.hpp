#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "motion/held_cautions.hpp"
#include "motion/motion_units.hpp"

namespace servoctl::motion {

/// Why a drive takes no commands from this bus, by the parameters that the family's data name (`[nmt]
/// needs`); empty where they do not say.
struct OtherSource {
  std::string cause;   ///< "P0.03 is 0, and 7 is needed for CANopen"
  std::string remedy;  ///< "`param set P0.03=7 -n 1` and restart the drive"
  bool is_known() const { return !cause.empty(); }
};

/// Judged by the values in force: where one waits for a restart, the value before it. Only reads. Errors are
/// those of the transfers; a parameter that the drive refuses to give says nothing.
Result<OtherSource> other_source(session::Session& session, const MotionUnits& units, const OwedValues& owed);

/// The line that sets a parameter so that it is still set after a restart:
/// "param set Fn_00=20 -n 1 --unlock --keep".
std::string lasting_setting(const drive::Profile& profile, std::uint8_t node, std::string_view name,
                            std::int64_t value);

}  // namespace servoctl::motion
