#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/file_lock.hpp"
#include "session/identity.hpp"
#include "settings/backup_file.hpp"
#include "show/desk.hpp"

namespace servoctl::settings {

/// Whether the drive that a backup was taken from is the one that is there. A serial number tells it on
/// whatever bus; where there is none, the bus does.
struct Origin {
  enum class Kind : std::uint8_t {
    same,
    other,      ///< What it says of itself differs.
    elsewhere,  ///< Nothing of that differs, but it was on another bus.
    unknown     ///< Nothing that can be read says.
  };
  Kind kind = Kind::same;
  Message why = {};      ///< Such as `its serial number (1018h:04) differs`; empty for `same`.
  std::string bus = {};  ///< Where that drive was.
};

Origin origin_of(const show::Desk& desk, const Backup& backup, const session::Identity& drive);

/// The file for the old values of one drive, its journal beside it. What another drive held is never
/// replaced: where the usual name has that, the next one does (`good.json.before-node-1-drive-2.json`).
class BeforeFile {
 public:
  /// A name that is of another drive.
  struct PassedOver {
    std::filesystem::path path;
    Origin origin;
    bool has_journal = false;
  };

  /// Finds it and holds it, except for a dry run. Errc::refused when another process restores into this
  /// drive, and where a restore was cut off on another bus and nothing tells whether it was of this drive;
  /// Errc::file for a journal whose values cannot be read. `title` names in messages what is restored.
  static Result<BeforeFile> take(const show::Desk& desk, const std::filesystem::path& usual,
                                 const Message& title, const session::Identity& drive);
  /// Where take() would find it; holds nothing, and refuses nobody who restores.
  static Result<BeforeFile> find(const show::Desk& desk, const std::filesystem::path& usual,
                                 const Message& title, const session::Identity& drive);

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path journal() const;
  /// Those that are not of this drive.
  const std::vector<PassedOver>& passed_over() const { return passed_over_; }

 private:
  std::filesystem::path path_;
  std::vector<PassedOver> passed_over_;
  std::optional<FileLock> lock_;

  friend class BeforeFileSearch;
};

/// All names under which take() looks, the usual one first.
std::vector<std::filesystem::path> before_names(const std::filesystem::path& usual);

}  // namespace servoctl::settings
