#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "session/identity.hpp"

namespace servoctl::show {

/// What somebody said of a drive in a line that worked.
struct KnownDrive {
  std::string family;  ///< As after -d: a family's name, or the whole path of a file.
  std::string turn;    ///< As after --turn; empty where nobody said it.
  std::string time;    ///< UTC, when it was said.
  session::Identity identity;
};

/// The file in the folder for state that holds it: one for each bus, however that was written, and node.
class KnownDriveFile {
 public:
  KnownDriveFile(const std::filesystem::path& state_folder, std::string_view bus_url, std::uint8_t node);

  const std::filesystem::path& path() const { return path_; }
  /// Empty when there is none. Errc::file for one that is damaged.
  Result<std::optional<KnownDrive>> read() const;
  /// Errc::file.
  Result<void> write(const KnownDrive& drive) const;
  /// Errc::file when it cannot be taken away.
  Result<void> remove() const;

 private:
  std::uint8_t node_;
  std::filesystem::path path_;
};

}  // namespace servoctl::show
