
#include "base/format.hpp"
#include "base/text.hpp"
#include "command/command.hpp"
#include "drive/shared_profile.hpp"
#include "show/drive_rules.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kDrivesParameters[] = {
    {.name = "family", .help = "show the rules of this family", .kind = Kind::family},
};

Result<report::Value> run_drives(Context& context, const Arguments& arguments) {
  if (arguments.has("family")) {
    const auto loaded = drive::shared_profile(arguments.text("family"), context.drive_folders);
    if (!loaded) return fail(loaded.error());
    const auto& profile = **loaded;
    for (const auto& warning : profile.warnings) context.notices.push_back(warning);
    return report::Value(show::rules_record(profile, context.chinese));
  }
  report::Table table;
  table.columns = {{"family"},
                   {"vendor"},
                   {"name_text", "name", report::Show::text},
                   {"name", "", report::Show::json},
                   {"name_zh", "", report::Show::json},
                   {"files_text", "files", report::Show::text},
                   {"files", "", report::Show::json}};
  for (const auto& family : drive::find_families(context.drive_folders)) {
    const auto rules = drive::load_rules(family);
    if (!rules && rules.error().code == Errc::refused)
      context.notices.push_back(formatted("{}; {}", rules.error().message, rules.error().hint));
    const auto name = rules ? rules->name : std::string();
    const auto name_zh = rules ? rules->name_zh : std::string();
    table.rows.push_back({family.name, report::text_or_null(rules ? rules->vendor : std::string()),
                          report::text_or_null(context.chinese && !name_zh.empty() ? name_zh : name),
                          report::text_or_null(name), report::text_or_null(name_zh),
                          family.stem.string() + ".*", family.stem.string()});
  }
  if (table.rows.empty()) {
    std::string folders;
    for (const auto& folder : std::span<const std::filesystem::path>(context.drive_folders))
      append(folders, folder.string());
    return fail(Errc::file, "no drive data was found in " + folders, "set SERVOCTL_DRIVES to its folder");
  }
  return report::Value(std::move(table));
}

constexpr Example kDrivesExamples[] = {
    {"drives", "the families"},
    {"drives gsd600", "what has to be known of one: addresses, PDOs, storing, motion"},
};

}  // namespace

extern const Command kDrives;
const Command kDrives{
    .path = "drives",
    .summary = "List the drive families servoctl knows, or the rules of one",
    .details =
        "Put your own families into ~/.config/servoctl/drives or a folder in $SERVOCTL_DRIVES "
        "(docs/drive-data.md).",
    .parameters = kDrivesParameters,
    .examples = kDrivesExamples,
    .needs = Needs::nothing,
    .effect = Effect::none,
    .run = run_drives,
};

}  // namespace servoctl::commands
