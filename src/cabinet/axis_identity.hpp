#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "cabinet/cabinet.hpp"
#include "session/identity.hpp"
#include "show/desk.hpp"

namespace servoctl::cabinet {

/// Asks the drive at the place of an axis what it is, and holds that against the file: its family, by what
/// its data says of the drives of it, and its serial number where the file says one. `desk` has the session
/// and the family; `families` are those that there are. Errc::refused, with both serial numbers, for another
/// drive, for one that tells no serial number where the file says one, and for two nodes of one number;
/// Errc::timeout when none answers. What proves nothing is told in `desk.notices`.
Result<session::Identity> hold_axis_identity(show::Desk& desk, const Axis& axis,
                                             std::span<const drive::Family> families);

/// Before something is written for good: a second node of that number which answers late is waited for, as
/// before a motion, and the serial number is asked for again where the drive has started since. Errc::refused
/// when there is one, or it is another drive. Nothing is to be written in a dry run.
Result<void> wait_for_second(show::Desk& desk, const Axis& axis);

/// As the file writes it, and as `info` does: `305419896 (0x12345678)`; `none` for 0.
std::string serial_text(std::uint32_t serial);

/// Errc::refused where the file says another serial number (1018h:04) than the drive.
Result<void> hold_serial(const Axis& axis, const session::Identity& identity);

}  // namespace servoctl::cabinet
