#include "cli/state_folder.hpp"

#include <cstdlib>
#include <system_error>

namespace servoctl::cli {

std::filesystem::path state_folder() {
  std::filesystem::path base;
  if (const char* state = std::getenv("XDG_STATE_HOME"); state != nullptr && *state != '\0')
    base = state;
  else if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
    base = std::filesystem::path(home) / ".local/state";
  else
    return {};
  std::error_code error;
  std::filesystem::create_directories(base / "servoctl", error);
  return error ? std::filesystem::path() : base / "servoctl";
}

}  // namespace servoctl::cli
