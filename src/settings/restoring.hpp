#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "settings/backup_file.hpp"
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

/// How a restore ended.
enum class RestoreEnd : std::uint8_t {
  idle,         ///< Nothing differed, and nothing was written.
  planned,      ///< The answer is what would be sent.
  done,         ///< Every value is as wanted.
  not_kept,     ///< Every value is as wanted; keeping it, or locking the drive again, failed.
  rolled_back,  ///< It failed, and every value is as it was before.
  astray,       ///< It failed, and some values are neither, or are not known; the errors name them.
  left          ///< It failed, and what was written stays written, as was asked for.
};

/// What came of it.
struct Restored {
  report::Value answer;
  bool failed = false;  ///< Beyond values that are outside of the limits and left as they are.
  RestoreEnd end = RestoreEnd::idle;
};

/// Puts a backup into one node: checks identity, state and every value, shows what differs, asks, saves what
/// the node holds (`before`) and a journal beside it, and carries the restore out. `title` names the backup
/// in messages. Where a journal stands already Errc::refused, unless it is to be gone on with. `undoes` is
/// the journal of the restore that this one takes back, where there is one; it goes away when all is done.
/// The answer says what differed and how it ended; failures go to `desk.errors`.
Result<Restored> put_into(show::Desk& desk, const Backup& backup, const std::string& title, std::uint8_t node,
                          const std::filesystem::path& before, const RestoringOptions& options,
                          const std::filesystem::path& undoes = {});

}  // namespace servoctl::settings
