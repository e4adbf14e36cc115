#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "command/command.hpp"

namespace servoctl::command {

/// The data of a drive's family, for files that name several drives of the bus of the line: the one that is
/// `named`, or else that of the line, or that of the axis which the cabinet file has at this node of this
/// bus. Errc::usage where nobody says it; as FrontEnd::family() and FrontEnd::cabinet().
Result<const drive::Profile*> family_at(const Context& context, const std::string& named, std::uint8_t node);

/// The drive at `node` is at `to` now: where the cabinet file has an axis at the old place, on the bus of the
/// line, that is told as a notice. Not where it says another serial number than that of the drive.
void tell_moved_axis(Context& context, std::uint8_t node, std::uint8_t to,
                     std::optional<std::uint32_t> serial);

}  // namespace servoctl::command
