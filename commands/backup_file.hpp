#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "commands/command.hpp"
#include "session/snapshot.hpp"

namespace servoctl::commands {

/// A backup as it stands in a file.
struct Backup {
  struct Entry {
    ObjectAddress object;
    std::string id;  ///< Panel number, where it has one.
    std::string name;
    od::DataType type = od::DataType::bytes;
    std::optional<Bytes> bytes;
    std::string left_out;
    std::uint32_t line = 0;  ///< Of the file; from 1.
  };
  std::string family;
  std::string tool;
  std::string time;  ///< UTC, ISO 8601.
  std::string bus;
  session::Identity identity;
  std::vector<Entry> entries;
};

/// The backup of a snapshot, with names and types of the family.
Backup make_backup(const Context& context, const session::Snapshot& snapshot);

/// A checksum of everything a restore would use.
std::string checksum(const Backup& backup);

/// The file's text: JSON, one entry a line, with a checksum over node-independent content.
std::string backup_text(const Context& context, const Backup& backup);

/// Reads a backup. Errc::file, with line and entry, when it is truncated, edited (the checksum does not fit),
/// of a newer version, or has an entry twice.
Result<Backup> read_backup(const std::filesystem::path& file);

}  // namespace servoctl::commands
