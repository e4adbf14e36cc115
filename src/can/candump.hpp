#pragma once

#include <optional>
#include <string_view>

#include "can/asc.hpp"
#include "can/trace.hpp"

namespace servoctl::can {

/// Reads a line as `candump` of can-utils shows it on a terminal, without -L:
///
///     can0  601   [8]  40 00 10 00 00 00 00 00
///     (1736412345.123456)  can0  581   [8]  43 00 10 00 92 01 02 00   '@.......'
///
/// with the times of -ta, -tz (since 1970, or since the first frame) and -tA (a date, taken as UTC), what -x
/// puts behind the interface (`RX - -`) and what -a puts behind the data. Without a time it is 0. An
/// identifier of 8 digits has 29 bits, or is a report of the controller. Behind the data may stand a remark,
/// which does not begin like a byte. Empty for anything else, CAN FD frames included.
std::optional<LogFrame> parse_candump_line(std::string_view line);

/// Reads a line of candump in any form, or a command of cansend (`cansend can0 601#40.41.60.00`, without a
/// time). Blank lines, remarks and what -e writes under an error frame are remarks.
AscLine read_candump(std::string_view line);

/// Whether a line is a CAN FD frame as candump writes it: `##` (-L), or a length of two digits (`[08]`).
bool is_candump_fd(std::string_view line);

}  // namespace servoctl::can
