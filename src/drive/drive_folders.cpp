// Where the data of the families stand.
#include <algorithm>
#include <cstdlib>
#include <optional>
#include <system_error>
#include <utility>

#include "base/text.hpp"
#include "drive/profile.hpp"

namespace servoctl::drive {
namespace fs = std::filesystem;
namespace {

/// The program's own data: beside an installed program, or in the source tree of one that was just built.
std::optional<fs::path> own_folder() {
  std::error_code ignored;
  const auto program = fs::read_symlink("/proc/self/exe", ignored);
  if (ignored) return std::nullopt;
  for (auto folder = program.parent_path(); folder.has_relative_path(); folder = folder.parent_path()) {
    if (fs::is_directory(folder / "share/servoctl/eds", ignored)) return folder / "share/servoctl/eds";
    if (fs::is_directory(folder / "eds", ignored) && fs::exists(folder / "CMakeLists.txt", ignored))
      return folder / "eds";
  }
  return std::nullopt;
}

}  // namespace

std::vector<fs::path> drive_folders() {
  std::vector<fs::path> out;
  if (const char* own = std::getenv("SERVOCTL_DRIVES"); own != nullptr)
    for (const auto part : split(std::string_view(own), ':'))
      if (!part.empty()) out.emplace_back(part);
  if (const char* config = std::getenv("XDG_CONFIG_HOME"); config != nullptr && *config != '\0')
    out.push_back(fs::path(config) / "servoctl/drives");
  else if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
    out.push_back(fs::path(home) / ".config/servoctl/drives");
  if (auto own = own_folder()) out.push_back(std::move(*own));
  return out;
}

const Family* find_family(std::span<const Family> families, std::string_view name) {
  const auto found = std::find_if(families.begin(), families.end(),
                                  [&](const Family& family) { return equals_nocase(family.name, name); });
  return found == families.end() ? nullptr : &*found;
}

Folders::operator std::span<const fs::path>() const {
  if (given_) return *given_;
  static const auto found = drive_folders();
  return found;
}

}  // namespace servoctl::drive
