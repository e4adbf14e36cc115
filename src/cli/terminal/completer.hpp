#pragma once

#include <string_view>

#include "cli/shell.hpp"
#include "cli/terminal/line_editor.hpp"

namespace servoctl::cli {

/// Completes the last word of `line` (empty after a blank) from the registry, from the data of the drive in
/// use, from what was heard of the bus, and from the disk. What a shell line would take for something else
/// stands behind a backslash. No frame is sent for it.
Offer complete(std::string_view line, Shell& shell);

}  // namespace servoctl::cli
