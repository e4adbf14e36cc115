#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "base/result.hpp"
#include "session/snapshot.hpp"
#include "show/desk.hpp"

namespace servoctl::settings {

/// What a restore notes beside the backup before its first write, and takes away when the drive holds all of
/// one or of the other: with it a restore that was cut off (a pulled cable, a crash, `kill -9`) can be gone
/// on with or undone.
struct RestoreJournal {
  std::string checksum;  ///< Of the backup that is being restored.
  std::uint8_t node = 0;
  bool with_address = false;
  bool force = false;
  bool keep = false;
  bool unlock = false;
  /// Memory switch and password as they were: a restore that is cut off leaves them as it needed them.
  std::vector<std::pair<ObjectAddress, Bytes>> means;
};

/// Whether the drive worked in its RAM when the restore began: what it answered may have been trials.
bool worked_in_ram(const drive::Profile& profile, const RestoreJournal& journal);

/// Where the journal of a restore stands whose values from before are in this file.
std::filesystem::path journal_of(const std::filesystem::path& before);

/// Reads a journal; empty when there is none. It is foreign data as a backup is: Errc::file for one that
/// cannot be understood, was changed after it was written, or is of no node, and for one that names an object
/// that the family of the desk does not write for the sake of other writes (drive::means_of_writing()), or
/// a value outside of its limits.
Result<std::optional<RestoreJournal>> read_journal(const show::Desk& desk, const std::filesystem::path& path);

/// Writes a journal; it is on the disk when this returns.
Result<void> write_journal(const std::filesystem::path& path, const RestoreJournal& journal);

/// Before the first write: saves what a node holds as a backup in `before`, and the journal beside it. A
/// journal without memory switch and password gets them as they are now.
Result<void> note_before(const show::Desk& desk, const std::filesystem::path& before,
                         const session::Snapshot& snapshot, RestoreJournal journal);
/// The same without the values, where the drive holds them already: those that stand in `before` are of an
/// earlier restore, and stay.
Result<void> note_journal(const show::Desk& desk, const std::filesystem::path& before,
                          RestoreJournal journal);

/// Memory switch and password as they were before what was cut off.
Result<void> put_means_back(session::Session& session, const RestoreJournal& journal);

}  // namespace servoctl::settings
