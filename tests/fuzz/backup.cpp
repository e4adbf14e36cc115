// Backups in the formats of other tools; the first byte chooses the format.
#include <filesystem>

#include "cli/running_line.hpp"
#include "cli/shell.hpp"
#include "settings/backup_formats.hpp"
#include "tests/cli/recording_console.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/source_dir.hpp"

using namespace servoctl;
using settings::Backup;
using settings::BackupFormat;

namespace {

const std::vector<std::filesystem::path> kFolders{std::filesystem::path(source_dir()) / "eds"};

const drive::Profile& profile() {
  static const auto loaded = drive::load_profile("gsd600", kFolders).value();
  return loaded;
}

command::Context& context() {
  static cli::RecordingConsole console;
  static cli::Shell::Options options;
  options.drive_folders = kFolders;
  static cli::Shell shell(console, options);
  static command::Context out;
  static cli::Settings settings;
  static cli::RunningLine line(shell, settings, out);
  out.notices.clear();
  return out;
}

std::map<ObjectAddress, Bytes> values(const Backup& backup) {
  std::map<ObjectAddress, Bytes> out;
  for (const auto& entry : backup.entries)
    // What is outside of the limits stands in a table for readers only.
    if (entry.bytes &&
        settings::range_missed(profile(), backup.identity.node, entry.object, *entry.bytes).empty())
      out.emplace(entry.object, *entry.bytes);
  return out;
}

Result<Backup> read(std::string text, BackupFormat format) {
  return settings::read_backup(context(), {"fuzz", std::move(text), format, context().front_end}, &profile(),
                               1);
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  constexpr BackupFormat kFormats[] = {BackupFormat::dcf, BackupFormat::csv, BackupFormat::batch,
                                       BackupFormat::concise_dcf, BackupFormat::json};
  const auto backup =
      read(std::string(fuzz::text(data + 1, size - 1)), kFormats[data[0] % std::size(kFormats)]);
  if (!backup) {
    fuzz::require(backup.error().code == Errc::file, "a backup that cannot be read is Errc::file");
    return 0;
  }
  if (data[0] % std::size(kFormats) == 4) return 0;
  for (const auto& setting : drive::settings_of(profile()))
    if (!setting.left_out.empty())
      fuzz::require(values(*backup).count(setting.entry->address) == 0,
                    "only settings are taken from a file");
  const auto table = read(settings::csv_text(profile(), *backup), BackupFormat::csv);
  fuzz::require(table && values(*table) == values(*backup), "a table says what was read");
  return 0;
}
