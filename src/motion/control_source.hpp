#pragma once

#include <cstdint>
#include <string>

#include "drive/profile.hpp"
#include "session/session.hpp"

namespace servoctl::motion {

/// Why a drive takes no commands from this bus, by its own parameters; empty where they do not say.
struct OtherSource {
  std::string cause;   ///< "P0.03 is 0, and 7 is needed for CANopen"
  std::string remedy;  ///< "`param set P0.03=7 -n 1` and restart the drive"
  bool is_known() const { return !cause.empty(); }
};

/// Reads what the family's data name (`[nmt] needs`); one that cannot be read says nothing.
OtherSource other_source(session::Session& session, const drive::Profile& profile, std::uint8_t node);

}  // namespace servoctl::motion
