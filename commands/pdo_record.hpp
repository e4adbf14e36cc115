#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "commands/command.hpp"
#include "commands/restore_journal.hpp"
#include "session/write_plan.hpp"

namespace servoctl::commands {

/// What the PDOs of a node were before a change that is under way: a backup that `pdo apply` reads, with the
/// journal of a restore beside it, in the folder for state. It goes away when the change has ended one way or
/// the other; what stands there later tells of one that was cut off (a crash, `kill -9`, a pulled cable).
/// Without such a folder nothing is kept.
class PdoRecord {
 public:
  /// `context` outlives it.
  PdoRecord(const Context& context, std::uint8_t node);

  /// Before the first write. A record that stands there already is older, and stays what it is. Errc::file.
  Result<void> begin(const session::Values& present, bool keep, bool unlock);
  /// The journal, when `file` is this record, which is to be put back then; empty for any other file.
  Result<std::optional<RestoreJournal>> take_up(const std::filesystem::path& file);
  /// The PDOs are as wanted, or as they were: takes away what begin() wrote or take_up() found.
  void settle();

  /// Of a change that did not come to its end: since when, and how it is put back. Empty where there is none.
  std::string notice() const;

 private:
  bool exists() const;

  const Context* context_;
  std::uint8_t node_;
  std::filesystem::path file_;  ///< Empty where nothing is kept.
  bool mine_ = false;
};

/// Adds to the notices which nodes of the context have such a record.
void tell_cut_off_changes(Context& context);

}  // namespace servoctl::commands
