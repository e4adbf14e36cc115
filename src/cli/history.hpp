#pragma once

#include <filesystem>

namespace servoctl::cli {

/// `$XDG_STATE_HOME/servoctl/history` or `~/.local/state/servoctl/history`; the folder is made. Empty when
/// there is no home.
std::filesystem::path history_file();

}  // namespace servoctl::cli
