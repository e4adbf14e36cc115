#include "base/format.hpp"
#include "base/text.hpp"
#include "command/command.hpp"
#include "drive/family_mistakes.hpp"
#include "drive/shared_profile.hpp"
#include "show/drive_rules.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kDrivesParameters[] = {
    {.name = "family", .help = "show the rules of this family", .kind = Kind::family},
};

std::vector<report::Value> row_of(Context& context, const drive::Family& family) {
  const auto rules = drive::load_rules(family);
  const auto errors = drive::count_errors(drive::mistakes_of(family, context.drive_folders));
  if (!rules && rules.error().code == Errc::refused)
    context.notices.push_back(message("{}; {}", rules.error().message, rules.error().hint));
  else if (errors > 0)
    context.notices.push_back(message("{0} is broken: {1} error{2}; `drives check {0}` lists them",
                                      as_it_is(family.name), errors, plural(errors)));
  const auto name = rules ? rules->name : std::string();
  const auto name_zh = rules ? rules->name_zh : std::string();
  const auto& shown = context.chinese && !name_zh.empty() ? name_zh : name;
  return {family.name,
          report::text_or_null(rules ? rules->vendor : std::string()),
          errors > 0 ? report::Value("broken") : report::text_or_null(shown),
          report::text_or_null(name),
          report::text_or_null(name_zh),
          family.stem.string() + ".*",
          family.stem.string(),
          errors};
}

Result<report::Value> run_drives(Context& context, const Arguments& arguments) {
  if (arguments.has("family")) {
    const auto loaded = drive::shared_profile(arguments.text("family"), context.drive_folders);
    if (!loaded) return fail(loaded.error());
    const auto& profile = **loaded;
    for (const auto& warning : profile.warnings) context.notices.push_back(warning);
    return report::Value(show::rules_record(profile, context.chinese));
  }
  const std::span<const std::filesystem::path> folders = context.drive_folders;
  report::Table table;
  table.columns = {{"family"},
                   {"vendor"},
                   {"name_text", "name", report::Show::text},
                   {"name", "", report::Show::json},
                   {"name_zh", "", report::Show::json},
                   {"files_text", "files", report::Show::text},
                   {"files", "", report::Show::json},
                   {"errors", "", report::Show::json}};
  for (const auto& family : drive::find_families(folders)) table.rows.push_back(row_of(context, family));
  if (table.rows.empty()) {
    std::string missing;
    for (const auto& folder : std::span<const std::filesystem::path>(context.drive_folders))
      append(missing, folder.string());
    return fail(Errc::file, "no drive data was found in " + missing, "set SERVOCTL_DRIVES to its folder");
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
        "(docs/drive-data.md). A family whose files have errors is listed as broken; `drives check` names the errors.",
    .parameters = kDrivesParameters,
    .examples = kDrivesExamples,
    .needs = Needs::nothing,
    .effect = Effect::none,
    .run = run_drives,
};

}  // namespace servoctl::commands
