#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cli/shell.hpp"

namespace servoctl::cli {

/// What the command lines of a batch file write, each with the node and family the file has chosen for it;
/// nothing is run, and what holds for the shell (its bus, node and family) does not count. Errc::file with
/// file and line for the first that is wrong, and for what is no command line (`pause`, `expect`, `wait`).
Result<std::vector<settings::SettingLine>> setting_lines(Shell& shell, std::string_view text,
                                                         const std::string& file);

}  // namespace servoctl::cli
