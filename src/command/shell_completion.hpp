#pragma once

#include <string>
#include <string_view>

namespace servoctl::command {

/// The completion script for `bash`, `zsh` or `fish`. It knows no word itself: at each Tab it asks the
/// program
/// (`servoctl __complete …`, cli/tab_answer), which opens no bus for it.
std::string completion_script(std::string_view shell);

/// Whether a name may be offered where a command line is completed by scripts that put in what they get: it
/// stands for itself in a shell. Names come from files.
bool can_be_offered(std::string_view name);

}  // namespace servoctl::command
