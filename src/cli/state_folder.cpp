#include "cli/state_folder.hpp"

#include <sys/stat.h>

#include <cstdlib>
#include <system_error>

#include "base/format.hpp"
#include "base/found_file.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;

fs::path place() {
  if (const char* state = std::getenv("XDG_STATE_HOME"); state != nullptr && *state != '\0')
    return fs::path(state) / "servoctl";
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
    return fs::path(home) / ".local/state/servoctl";
  return {};
}

}  // namespace

StateFolder state_folder_as_it_is() {
  auto folder = place();
  std::error_code ignored;
  if (!fs::exists(fs::symlink_status(folder, ignored))) return {folder, {}};
  const auto own = check_own_folder(folder);
  if (own) return {folder, {}};
  return {{},
          formatted("{}: nothing is kept or remembered there; {}", own.error().message.text(),
                    own.error().hint.text())};
}

StateFolder state_folder() {
  const auto folder = place();
  if (folder.empty()) return {};
  std::error_code error;
  fs::create_directories(folder.parent_path(), error);
  constexpr mode_t kForThisUser = 0700;
  const bool made = ::mkdir(folder.c_str(), kForThisUser) == 0;
  if (!made && !fs::is_directory(folder, error)) return {};
  return state_folder_as_it_is();
}

}  // namespace servoctl::cli
