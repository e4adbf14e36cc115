#pragma once

#include <cstdint>

#include "drive/profile.hpp"
#include "drive/standard_objects.hpp"
#include "session/session.hpp"

namespace servoctl::motion {

/// The mode the drive is in, by 6061h.
Result<std::int8_t> read_mode(session::Session& session, std::uint8_t node);

/// A manufacturer's mode (below 0) of a drive whose data are the standard's: what it does is not known.
bool is_unknown_maker_mode(const drive::Profile& profile, std::int8_t mode);

/// Errc::refused when the family's list (labels of 6060h) or the drive itself (6502h, where it tells) does
/// not have the mode; never for is_unknown_maker_mode(). Reads one object at most.
Result<void> check_mode(session::Session& session, const drive::Profile& profile, std::uint8_t node,
                        std::int8_t mode);

/// What set_mode() writes: 6060h in the length that the family has it.
session::SdoRequest mode_write(const drive::Profile& profile, std::uint8_t node, std::int8_t mode);

/// Writes 6060h and waits until 6061h follows. Errc::negative when it does not in a second.
Result<void> set_mode(session::Session& session, const drive::Profile& profile, std::uint8_t node,
                      std::int8_t mode);

/// `3 Profile velocity (pv)`.
std::string mode_text(const drive::Profile& profile, std::int8_t mode, bool chinese = false);

}  // namespace servoctl::motion
