#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "settings/backup_file.hpp"
#include "settings/restore_end.hpp"
#include "settings/restore_target.hpp"
#include "show/desk.hpp"

namespace servoctl::settings {

/// How a backup goes into a drive.
struct RestoringOptions {
  RestoreChoice choice;
  bool roll_back = true;
  bool keep = false;
  bool unlock = false;
  bool resume = false;  ///< Go on with the one that its journal tells of; its options hold then.
  /// What the drive held of these values when somebody agreed to the change: another value now, or an object
  /// more or less, is Errc::refused. Empty: nobody is held to anything.
  std::optional<session::Values> expected = {};
};

/// What came of it.
struct Restored {
  report::Value answer;
  bool failed = false;  ///< Beyond values that are left as they are (RestoreTarget::left()).
  RestoreEnd end = RestoreEnd::idle;
  std::vector<ObjectAddress> in_flash = {};  ///< As in session::RestoreOutcome.
  std::filesystem::path before = {};         ///< Where the old values are, if any were noted.
};

/// Puts a backup into one node: checks identity, state and every value, shows what differs, asks, saves what
/// the node holds (`before`, or the next name where that has the old values of another drive, see BeforeFile)
/// and a journal beside it, and carries the restore out. `title` names the backup in messages. Where a
/// journal stands already Errc::refused, unless it is to be gone on with. `undoes` is the journal of the
/// restore that this one takes back, where there is one; it goes away when all is done. The answer says what
/// differed and how it ended; failures go to `desk.errors`.
Result<Restored> put_into(show::Desk& desk, const Backup& backup, const Message& title, std::uint8_t node,
                          const std::filesystem::path& before, const RestoringOptions& options,
                          const std::filesystem::path& undoes = {});

}  // namespace servoctl::settings
