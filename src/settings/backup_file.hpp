#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "session/snapshot.hpp"
#include "settings/setting_line.hpp"
#include "show/desk.hpp"

namespace servoctl::settings {

/// A backup as it stands in a file.
struct Backup {
  struct Entry {
    ObjectAddress object;
    std::string id;  ///< Panel number, where it has one.
    std::string name;
    od::DataType type = od::DataType::bytes;
    std::optional<Bytes> bytes;
    std::string left_out;
    std::uint32_t line = 0;  ///< Of the file, or number of the entry where it has no lines; from 1.
  };
  bool proven = false;  ///< What servoctl read from a drive, whole: by its checksum, or just now.
  std::string family;
  std::string tool;
  std::string time;  ///< UTC, ISO 8601.
  std::string bus;
  session::Identity identity;
  std::vector<Entry> entries;
  /// Of a file of another form: entries that cannot be used, with line and reason. They are not in `entries`.
  std::vector<Error> unusable;
  std::vector<Message> passed_over;  ///< Entries that mean nothing, with the line.
};

/// The forms settings are kept in. All are read; the last one is not written.
enum class BackupFormat : std::uint8_t {
  json,        ///< Ours: with identity and checksum.
  dcf,         ///< Device configuration file, CiA 306-1.
  csv,         ///< A table.
  batch,       ///< Command lines, ours or of CiA 309-3.
  concise_dcf  ///< The value of object 1F22h, CiA 302-3.
};

/// The words of `--format`, in the order of BackupFormat.
inline constexpr std::string_view kBackupFormats[] = {"json", "dcf", "csv", "batch"};

/// The format a file of this name is written in: by `word` (of kBackupFormats) unless empty, else by the
/// extension, else JSON.
BackupFormat format_of(const std::filesystem::path& file, std::string_view word);
/// `.json .dcf .csv .servoctl`
std::string_view extension_of(BackupFormat format);

/// The backup of a snapshot, with names and types of the family. A COB-ID that no drive may have
/// (check_cob_id()) is left out, with the reason: what is saved can be put back.
Backup make_backup(const show::Desk& desk, const session::Snapshot& snapshot);

/// Names in `desk.notices` what a backup leaves out although it is a setting: a COB-ID that no drive may
/// have.
void tell_left_out(show::Desk& desk, const Backup& backup);

/// A checksum of everything a restore would use.
std::string checksum(const Backup& backup);

/// The file's text as JSON: one entry a line, with a checksum over node-independent content.
std::string backup_text(const show::Desk& desk, const Backup& backup);

/// The file's text in any format; the others than JSON are told in backup_formats.hpp. `file` stands in a DCF
/// as its name. What cannot stand in the format is told in `desk.notices`.
Result<std::string> backup_text(show::Desk& desk, const Backup& backup, BackupFormat format,
                                const std::filesystem::path& file);

/// A file that is to be read as a backup.
struct BackupSource {
  std::string file;  ///< For messages.
  std::string text;
  BackupFormat format = BackupFormat::json;
  LineReader* lines = nullptr;  ///< Who understands command lines; null: nobody.
};

/// Reads the file and recognises its format by its content. Errc::file.
Result<BackupSource> open_backup(const std::filesystem::path& file, LineReader* lines);

/// Whether the file is a backup in one of the formats, or empty: nothing else is lost where it is replaced. A
/// concise DCF, which nobody writes here, is none.
bool is_backup(const std::filesystem::path& file, LineReader* lines);

/// The family the file names; empty when it names none.
std::string family_of(const BackupSource& source);

/// Takes a backup apart. Errc::file, with line and entry, when it is truncated, edited (the checksum does not
/// fit), of a newer version, has an entry twice, or in another format than JSON an entry the family does not
/// know or whose value does not fit; with `skip_invalid` such an entry is left out, and its error in
/// `desk.errors`. What is no setting (commands, targets, readings) is left out, with the
/// reason. A file that says no node is taken as of `node`; `profile` may be null for JSON alone. What a
/// format cannot prove is told in `desk.notices`.
Result<Backup> read_backup(show::Desk& desk, const BackupSource& source, const drive::Profile* profile,
                           std::uint8_t node, bool skip_invalid = false);
/// The same, with the family of the desk.
Result<Backup> read_backup(show::Desk& desk, const std::filesystem::path& file, LineReader* lines,
                           std::uint8_t node, bool skip_invalid = false);
/// A backup in JSON: what servoctl keeps for itself.
Result<Backup> read_backup(const std::filesystem::path& file);

}  // namespace servoctl::settings
