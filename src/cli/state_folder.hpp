#pragma once

#include <filesystem>

namespace servoctl::cli {

/// `$XDG_STATE_HOME/servoctl` or `~/.local/state/servoctl`: history of the prompt, records of changes under
/// way. The folder is made. Empty when there is no home.
std::filesystem::path state_folder();

/// The same where nothing is to be kept: it is not made, and may not be there.
std::filesystem::path state_folder_as_it_is();

}  // namespace servoctl::cli
