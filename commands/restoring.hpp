#pragma once

#include <filesystem>
#include <string>

#include "commands/backup_file.hpp"
#include "commands/command.hpp"

namespace servoctl::commands {

/// How a backup goes into a drive.
struct RestoringOptions {
  bool with_address = false;  ///< Node-ID and bitrate as well.
  bool roll_back = true;
  bool force = false;  ///< Although identity or family are others; what does not fit is left out.
  bool keep = false;
  bool unlock = false;
};

/// Puts a backup into one node: checks identity, state and every value, shows what differs, asks, saves what
/// the node holds (`before`), and carries the restore out. `title` names the backup in messages. The answer
/// says what differed and how it ended; failures go to `context.errors`.
Result<report::Value> put_into(Context& context, const Backup& backup, const std::string& title,
                               std::uint8_t node, const std::filesystem::path& before,
                               const RestoringOptions& options);

}  // namespace servoctl::commands
