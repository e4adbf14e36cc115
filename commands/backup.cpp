#include <fmt/format.h>
#include <array>
#include <system_error>

#include "base/file.hpp"
#include "commands/backup_file.hpp"
#include "commands/command.hpp"
#include "commands/records.hpp"

namespace servoctl::commands {
namespace {

using report::Show;
using report::Value;

constexpr Parameter kParameters[] = {
    {.name = "file", .help = "file of one drive, folder of several", .kind = Kind::file, .required = true},
    {.name = "--only", .help = "communication, pdo, params, or a group of parameters", .kind = Kind::text},
};

bool is_pdo(std::uint16_t index) { return index >= 0x1400 && index <= 0x1BFF; }

Result<session::SettingFilter> filter_of(const Context& context, const Arguments& arguments) {
  if (!arguments.has("--only")) return session::SettingFilter{};
  const std::string word(arguments.text("--only"));
  if (word == "communication")
    return session::SettingFilter{[](const auto& s) { return s.entry->address.index < 0x2000; }};
  if (word == "pdo")
    return session::SettingFilter{[](const auto& s) { return is_pdo(s.entry->address.index); }};
  if (word == "params") return session::SettingFilter{[](const auto& s) { return s.parameter != nullptr; }};
  bool known = false;
  for (const auto& parameter : context.profile->parameters) known = known || parameter.group == word;
  if (!known)
    return fail(Errc::usage, fmt::format("'{}' is no part of a backup", word),
                "there are communication, pdo, params and the groups that `param list --json` shows");
  return session::SettingFilter{
      [word](const auto& s) { return s.parameter != nullptr && s.parameter->group == word; }};
}

std::filesystem::path file_for(const std::filesystem::path& path, std::uint8_t node, bool many) {
  return many ? path / fmt::format("node-{}.json", node) : path;
}

Result<void> make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail(Errc::file, fmt::format("{}: {}", folder.string(), error.message()));
  return {};
}

Result<Value> run(Context& context, const Arguments& arguments) {
  const auto wanted = filter_of(context, arguments);
  if (!wanted) return tl::unexpected<Error>(wanted.error());
  const std::filesystem::path path(arguments.text("file"));
  const bool many = context.nodes.size() > 1;
  if (many)
    if (const auto made = make_folder(path); !made) return tl::unexpected<Error>(made.error());
  const auto snapshots = session::take_snapshots(*context.session, *context.profile, context.nodes, *wanted);
  report::Table table;
  table.columns = {{"node"}, {"file"}, {"values"}, {"left_out", "left out"}, {"error", "", Show::json}};
  for (std::size_t i = 0; i < snapshots.size(); ++i) {
    const auto node = context.nodes[i];
    const auto file = file_for(path, node, many);
    Result<void> written;
    std::size_t values = 0;
    std::size_t left_out = 0;
    if (snapshots[i]) {
      const auto backup = make_backup(context, *snapshots[i]);
      for (const auto& entry : backup.entries) ++(entry.bytes ? values : left_out);
      written = write_file_atomically(file, backup_text(context, backup));
    } else {
      written = tl::unexpected<Error>(snapshots[i].error());
    }
    if (!written) context.errors.push_back(written.error());
    table.rows.push_back({node, written ? Value(file.string()) : Value("not written"), values, left_out,
                          written ? Value() : error_record(written.error())});
  }
  table.json_only = context.errors.size() == snapshots.size();
  return Value(std::move(table));
}

}  // namespace

extern const Command kBackup;
const Command kBackup{
    .path = "backup",
    .summary = "Save the settings of a drive into a file",
    .details =
        "Parameters and writable objects, as JSON, one a line, with identity and checksum; several nodes are "
        "read at "
        "the same time and go into a folder, node-N.json each. What is no setting (commands, readings, "
        "targets) or is "
        "refused by the drive stands in the file with the reason. A file is written whole or not at all.",
    .parameters = kParameters,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::reads,
    .run = run,
};

}  // namespace servoctl::commands
