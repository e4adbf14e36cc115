#pragma once

#include <cstdint>

#include "drive/caution.hpp"
#include "drive/profile.hpp"
#include "session/session.hpp"

/// What each kind of motion needs of a drive: its mode of operation (6060h, 6502h) and the object of its
/// target.
namespace servoctl::motion {

/// The mode of operation of a motion, by the data of the drive alone. Errc::refused where they lack the mode
/// or its objects: the error names what is missing, and the motions that are left.
Result<std::int8_t> mode_for(const drive::Profile& profile, drive::Use use);

/// The same, and what the drive itself says (6502h). For a drive without data of its own (`cia402`) the
/// object of the target is read as well. Reads two objects at most.
Result<std::int8_t> mode_for(session::Session& session, const drive::Profile& profile, std::uint8_t node,
                             drive::Use use);

/// Supported drive modes, as the drive tells them; 0 where it does not. Errors of an answer that was lost.
Result<std::uint64_t> supported_modes(session::Session& session, const drive::Profile& profile,
                                      std::uint8_t node);

/// Whether the mode is one of these (bit 0 is mode 1), as far as they tell.
bool supports(std::uint64_t modes, std::int8_t mode);

/// What a drive with these modes can do: "possible with this drive: `move`"; empty where nothing is left.
std::string possible_motions(const drive::Profile& profile, std::uint64_t modes);

}  // namespace servoctl::motion
