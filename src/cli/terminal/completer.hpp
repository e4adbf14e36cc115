#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cli/shell.hpp"
#include "cli/terminal/begun_place.hpp"
#include "cli/terminal/candidates.hpp"
#include "cli/terminal/line_editor.hpp"

namespace servoctl::cli {

/// Completes the last word of `line` (empty after a blank) from the registry, from the data of the drive in
/// use, from what was heard of the bus, and from the disk. What a shell line would take for something else
/// stands behind a backslash. No frame is sent for it, and no
/// device or pipe is opened.
Offer complete(std::string_view line, Shell& shell);

/// What may follow these words in the line of a shell, where `begun` was typed of the next one. Nothing is
/// opened for it but regular files.
Candidates complete_in_shell(const std::vector<std::string>& words, const std::string& begun, Shell& shell);

}  // namespace servoctl::cli
