#include "cli/state_folder.hpp"

#include <cstdlib>
#include <system_error>

namespace servoctl::cli {

std::filesystem::path state_folder_as_it_is() {
  if (const char* state = std::getenv("XDG_STATE_HOME"); state != nullptr && *state != '\0')
    return std::filesystem::path(state) / "servoctl";
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
    return std::filesystem::path(home) / ".local/state/servoctl";
  return {};
}

std::filesystem::path state_folder() {
  auto folder = state_folder_as_it_is();
  std::error_code error;
  if (!folder.empty()) std::filesystem::create_directories(folder, error);
  return error ? std::filesystem::path() : folder;
}

}  // namespace servoctl::cli
