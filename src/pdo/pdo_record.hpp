#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "session/scan.hpp"
#include "session/write_plan.hpp"
#include "settings/restore_journal.hpp"
#include "show/desk.hpp"

namespace servoctl::pdo {

/// What the PDOs of a drive were before a change that is under way: a backup that `pdo apply` reads, with the
/// journal of a restore beside it, in the folder for state. Its name tells the bus, however that was written,
/// the node, and the drive as far as that tells vendor, product and serial number (1018h): another drive that
/// is put at the node has a record of its own, and is not given the PDOs of this one. It goes away when the
/// change has ended one way or the other; what stands there later tells of one that was cut off (a crash,
/// `kill -9`, a pulled cable). Without such a folder nothing is kept.
class PdoRecord {
 public:
  /// `desk` outlives it.
  PdoRecord(const show::Desk& desk, std::uint8_t node);

  /// Before the first write. A record that stands there already is older, and stays what it is. Errc::file.
  Result<void> begin(const session::Values& present, bool keep, bool unlock);
  /// The journal, when `file` is a record of this node, which is to be put back then; empty for any other
  /// file. Errc::refused when the record is of another drive.
  Result<std::optional<settings::RestoreJournal>> take_up(const std::filesystem::path& file);
  /// The PDOs are as wanted, or as they were: takes away what begin() wrote or take_up() found.
  void settle();

  /// Of changes that did not come to their end: since when, and how they are put back.
  std::vector<Message> notices() const;

 private:
  std::vector<std::filesystem::path> found() const;
  Message notice_of(const std::filesystem::path& record, const std::optional<session::Identity>& drive) const;

  const show::Desk* desk_;
  std::uint8_t node_;
  std::string name_;            ///< With which the names of all records of this node begin.
  std::filesystem::path file_;  ///< Of begin() or take_up().
  bool mine_ = false;
};

/// Adds to the notices which nodes of the desk have such a record.
void tell_cut_off_changes(show::Desk& desk);

}  // namespace servoctl::pdo
