#include <algorithm>
#include <set>
#include <system_error>

#include "base/file.hpp"
#include "base/format.hpp"
#include "base/text.hpp"
#include "canopen/pdo.hpp"
#include "command/command.hpp"
#include "settings/backup_file.hpp"
#include "settings/comparison.hpp"
#include "settings/selection.hpp"
#include "show/output_file.hpp"
#include "show/records.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Show;
using report::Value;

constexpr std::string_view kChanged = "changed";

constexpr Parameter kBackupParameters[] = {
    {.name = "file", .help = "file of one drive, folder of several", .kind = Kind::file, .required = true},
    {.name = "--format",
     .help = "json, dcf, csv or batch (default: by the file's extension, else json)",
     .kind = Kind::choice,
     .choices = settings::kBackupFormats},
    {.name = "--only",
     .help = "communication, pdo, params, changed (not at factory value), or a group of parameters",
     .kind = Kind::text},
};

Result<session::SettingFilter> filter_of(const Context& context, std::string_view word) {
  if (word.empty() || word == kChanged) return session::SettingFilter{};
  auto selection = settings::selection_of(*context.profile, word, {std::string(kChanged)});
  if (!selection) return fail(selection.error());
  return session::SettingFilter{
      [chosen = std::move(*selection)](const auto& setting) { return chosen(setting.entry->address); }};
}

/// A drive takes values of a PDO only while its COB-ID says that it is invalid, and entries of a mapping only
/// by its count: of a PDO that has changed, command lines need these too. `restore` reads them from the
/// drive.
bool is_needed_by_lines(ObjectAddress object, const std::set<std::uint16_t>& changed) {
  const auto place = canopen::pdo_at(object.index);
  if (!place) return false;
  const canopen::Pdo pdo{place->direction, place->number};
  return (place->mapping && changed.contains(object.index)) ||
         (!place->mapping && object.sub == 1 &&
          (changed.contains(pdo.communication_index()) || changed.contains(pdo.mapping_index())));
}

/// Takes away what is as the factory left it. A value whose default no manual states stays.
void keep_changed(const drive::Profile& profile, settings::Backup& backup, settings::BackupFormat format) {
  const auto factory = settings::factory_side(profile, backup.identity.node);
  const auto is_unchanged = [&](const settings::Backup::Entry& entry) {
    const auto found = factory.values.find(entry.object);
    return !entry.bytes || (found != factory.values.end() && found->second == *entry.bytes);
  };
  std::set<std::uint16_t> changed;
  if (format == settings::BackupFormat::batch)
    for (const auto& entry : backup.entries)
      if (!is_unchanged(entry)) changed.insert(entry.object.index);
  std::erase_if(backup.entries, [&](const settings::Backup::Entry& entry) {
    return is_unchanged(entry) && (!entry.bytes || !is_needed_by_lines(entry.object, changed));
  });
}

Result<void> make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail(Errc::file, message("{}: {}", as_it_is(folder.string()), error.message()));
  return {};
}

/// In which of the formats a file is that does not end as any of them.
void tell_format(Context& context, const std::filesystem::path& file, const Arguments& arguments,
                 settings::BackupFormat format) {
  const auto ending = lower(file.extension().string());
  if (arguments.has("--format") || settings::extension_of(format) == ending) return;
  context.notices.push_back(message(
      "{} is written as {}: it ends in none of .json, .dcf, .csv and .servoctl, and there is no --format",
      as_it_is(file.string()), settings::kBackupFormats[static_cast<std::size_t>(format)]));
}

struct Saved {
  std::size_t values = 0;
  std::size_t left_out = 0;
};

/// A batch file has a line for what any drive of the family takes; `restore` of another format knows more.
void tell_lines(Context& context, const std::filesystem::path& file, std::uint8_t node, std::size_t values) {
  show::Desk reader = context;
  const auto read = settings::read_backup(reader, file, context.front_end, node);
  if (!read) return;
  const auto lines = static_cast<std::size_t>(
      std::count_if(read->entries.begin(), read->entries.end(),
                    [](const settings::Backup::Entry& entry) { return entry.bytes.has_value(); }));
  if (lines == values) return;
  context.notices.push_back(message(
      "{} has lines for {} of {} values: node-ID, bitrate, what is outside of its limits and what may be "
      "read-only are comments, entries of PDOs that are not in use have none; JSON keeps all",
      as_it_is(file.string()), lines, values));
}

Result<Saved> save(Context& context, settings::Backup backup, bool changed, settings::BackupFormat format,
                   const std::filesystem::path& file) {
  if (changed) keep_changed(*context.profile, backup, format);
  settings::tell_left_out(context, backup);
  Saved out;
  for (const auto& entry : backup.entries) ++(entry.bytes ? out.values : out.left_out);
  const auto text = settings::backup_text(context, backup, format, file);
  if (!text) return fail(text.error());
  if (const auto written = write_file_atomically(file, *text); !written) return fail(written.error());
  if (format == settings::BackupFormat::batch) tell_lines(context, file, backup.identity.node, out.values);
  return out;
}

Result<Value> run_backup(Context& context, const Arguments& arguments) {
  const auto only = arguments.text("--only");
  const auto wanted = filter_of(context, only);
  if (!wanted) return fail(wanted.error());
  const std::filesystem::path path(arguments.text("file"));
  const bool many = context.nodes.size() > 1;
  const auto format = settings::format_of(path, arguments.text("--format"));
  if (many)
    if (const auto made = make_folder(path); !made) return fail(made.error());
  if (!many) tell_format(context, path, arguments, format);
  std::vector<std::filesystem::path> files;
  for (const auto node : context.nodes)
    files.push_back(many ? path / formatted("node-{}{}", node, settings::extension_of(format)) : path);
  for (const auto& file : files)
    if (const auto agreed = show::may_replace(file, context.read_only, context); !agreed)
      return fail(agreed.error());
  const auto snapshots =
      session::take_snapshots_patiently(*context.session, *context.profile, context.nodes, *wanted);
  report::Table table;
  table.columns = {
      {"node"}, {"file"}, {"values", "values saved"}, {"left_out", "left out"}, {"error", "", Show::json}};
  for (std::size_t i = 0; i < snapshots.size(); ++i) {
    const auto node = context.nodes[i];
    const auto& file = files[i];
    const auto saved = snapshots[i] ? save(context, settings::make_backup(context, *snapshots[i]),
                                           only == kChanged, format, file)
                                    : Result<Saved>(fail(snapshots[i].error()));
    if (!saved) context.errors.push_back(saved.error());
    table.rows.push_back({node, saved ? Value(file.string()) : Value("not written"),
                          saved ? saved->values : 0U, saved ? saved->left_out : 0U,
                          saved ? Value() : show::error_record(saved.error())});
  }
  table.json_only = context.errors.size() == snapshots.size();
  return Value(std::move(table));
}

constexpr Example kBackupExamples[] = {
    {"backup good.json -n 1 -d gsd600", "all settings of one drive"},
    {"backup cell -n 1,2 -d gsd600", "of several: cell/node-1.json and so on"},
    {"backup changed.csv --only changed -n 1 -d gsd600", "what is not at its factory value, as a table"},
};

}  // namespace

extern const Command kBackup;
const Command kBackup{
    .path = "backup",
    .summary = "Save the settings of a drive to a file",
    .details =
        "Saves parameters and writable objects, one per line; several nodes are read at the same time into a "
        "folder, as node-N.json. A file that exists is replaced only after a question. What is "
        "not a setting (commands, readings, targets) or is refused by the drive is listed with the reason. A "
        "file is written whole or not at all; where the bus is lost meanwhile it is waited for, 10 s at most, and all is "
        "read anew. JSON has identity and checksum: keep that one. A DCF (CiA 306) is "
        "for other tools, a table for a spreadsheet, a batch for `run`. `restore`, `diff` and `verify` read all "
        "of them.",
    .parameters = kBackupParameters,
    .examples = kBackupExamples,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::reads,
    .family = FamilyCheck::always,
    .run = run_backup,
    .one_file = "file",
    .on_registers = true,
};

}  // namespace servoctl::commands
