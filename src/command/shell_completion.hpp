#pragma once

#include <string>
#include <string_view>

namespace servoctl::command {

/// The completion script for `bash`, `zsh` or `fish`, made from the registry alone. Commands, options and
/// choices stand in it; names of objects, parameters and families come from `servoctl completion …` while the
/// user types, for the drive named on the line or in $SERVOCTL_DRIVE.
std::string completion_script(std::string_view shell);

/// The one for fish; the other two share their functions.
std::string fish_completion();

}  // namespace servoctl::command
