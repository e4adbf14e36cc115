#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "settings/before_file.hpp"
#include "settings/restore_journal.hpp"
#include "settings/restoring.hpp"

namespace servoctl::settings {

/// A restore into one drive, for which it is asked whether one was cut off.
struct RestoreAttempt {
  const Backup* backup = nullptr;
  Message title;                 ///< Of the backup, in messages.
  session::Identity drive;       ///< The one that is there, its node in it.
  std::filesystem::path undoes;  ///< The journal of the restore that this one takes back; empty: of none.
};

/// The journal of the restore into this drive that was cut off, and is to be gone on with, or is taken back;
/// empty when there is none. The options become those that it was begun with. A restore that was cut off is
/// gone on with or undone, never begun anew: what the drive held before is in its file, and must not be
/// replaced by what it holds now. Errc::refused for that, for other values than were being restored, and for
/// the journal of another drive; Errc::usage where there is nothing to resume.
Result<RestoreJournal> take_up_interrupted(show::Desk& desk, const BeforeFile& before,
                                           const RestoreAttempt& attempt, RestoringOptions& options);

/// Errc::usage, or Errc::refused where the one that was cut off was of another drive.
Error nothing_to_resume(const BeforeFile& before, const Message& title, std::uint8_t node);

}  // namespace servoctl::settings
