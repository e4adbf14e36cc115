#pragma once

#include <filesystem>
#include <string>

namespace servoctl::cli {

/// Where servoctl keeps what it remembers, and why it does not.
struct StateFolder {
  std::filesystem::path path;  ///< Empty: nothing is kept or remembered.
  std::string why_not;         ///< A notice; empty where there is a folder, and where there is no home.
};

/// `$XDG_STATE_HOME/servoctl` or `~/.local/state/servoctl`: history of the prompt, records of changes under
/// way. The folder is made, for this user alone. One that is another user's, or open to others, is not used.
StateFolder state_folder();

/// The same where nothing is to be kept: it is not made, and may not be there.
StateFolder state_folder_as_it_is();

}  // namespace servoctl::cli
