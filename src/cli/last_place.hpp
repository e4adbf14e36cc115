#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "cli/shell.hpp"

namespace servoctl::cli {

/// Where the lines of a prompt that was begun in this folder went, as far as they named no place.
struct LastPlace {
  std::string folder;
  std::string bus;
  std::string nodes;    ///< As after `use`; may be empty.
  std::string drive;    ///< The same after `drive`.
  std::string cabinet;  ///< The file that bus and nodes are named in; empty: they need none.
  std::string time;     ///< UTC.
};

/// The file in the folder for state that keeps the last place of each folder.
class LastPlaceFile {
 public:
  explicit LastPlaceFile(const std::filesystem::path& state_folder) : path_(state_folder / "prompt.json") {}

  /// That of the folder; empty when there is none. Errc::file for one that is damaged.
  Result<std::optional<LastPlace>> read(const std::string& folder) const;
  /// Errc::file.
  Result<void> write(const LastPlace& place) const;

 private:
  Result<std::vector<LastPlace>> read_all() const;

  std::filesystem::path path_;
};

/// For a prompt that was told neither bus nor node nor family: those of last time in this folder, and says
/// so. A bus whose opening sends nothing is opened; another one is left to the first line that needs it. One
/// that is not there any more is told, and so is a place that is not of the cabinet file in use, which is
/// stronger than what was remembered; nothing is taken then. True when it said anything.
bool take_last_place(Shell& shell, const std::filesystem::path& state_folder);

/// Keeps where the prompt is now, once it is somewhere that can be found again.
void keep_last_place(Shell& shell, const std::filesystem::path& state_folder);

}  // namespace servoctl::cli
