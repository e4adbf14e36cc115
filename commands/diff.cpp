#include <fmt/format.h>

#include "commands/command.hpp"
#include "commands/comparison.hpp"

namespace servoctl::commands {
namespace {

using report::Value;

constexpr std::string_view kFactory = "factory";

constexpr Parameter kDiffParameters[] = {
    {.name = "a", .help = "a backup, or factory", .kind = Kind::file, .required = true},
    {.name = "b", .help = "a backup, or factory", .kind = Kind::file, .required = true},
};

constexpr Parameter kVerifyParameters[] = {
    {.name = "file", .help = "a backup, or factory", .kind = Kind::file, .required = true},
};

/// The family named on the line, else that of a backup, where its data is at hand.
struct Family {
  std::optional<drive::Profile> loaded;
  const drive::Profile* profile = nullptr;

  void take(const Context& context, const std::string& name) {
    if (profile != nullptr || name.empty()) return;
    auto found = drive::load_profile(name, context.drive_folders);
    if (!found) return;
    loaded = std::move(*found);
    profile = &*loaded;
  }
};

Result<Value> run_diff(Context& context, const Arguments& arguments) {
  Family family{{}, context.profile};
  std::optional<Backup> backups[2];
  const std::string_view names[] = {arguments.text("a"), arguments.text("b")};
  for (std::size_t i = 0; i < 2; ++i) {
    if (names[i] == kFactory) continue;
    auto read = read_backup(names[i]);
    if (!read) return tl::unexpected<Error>(read.error());
    family.take(context, read->family);
    backups[i] = std::move(*read);
  }
  if (backups[0] && backups[1] && backups[0]->family != backups[1]->family)
    return fail(Errc::negative, fmt::format("{} is of {}, {} of {}: they have nothing to compare", names[0],
                                            backups[0]->family, names[1], backups[1]->family));
  std::vector<Side> sides;
  for (std::size_t i = 0; i < 2; ++i) {
    if (backups[i]) {
      sides.push_back(side_of(*backups[i], std::string(names[i])));
      continue;
    }
    if (family.profile == nullptr)
      return fail(Errc::usage, "factory values of which family?", "add -d FAMILY");
    const auto& other = backups[1 - i];
    sides.push_back(factory_side(*family.profile, other ? other->identity.node : std::uint8_t{1}));
  }
  // A backup of a part is compared by what it has.
  auto comparison = compare(family.profile, sides[0], sides[1], backups[0] && backups[1], context.chinese);
  if (comparison.different > 0) context.errors.push_back(differences_error(comparison, sides[0], sides[1]));
  return Value(std::move(comparison.record));
}

Result<Value> run_verify(Context& context, const Arguments& arguments) {
  const auto name = arguments.text("file");
  std::optional<Backup> backup;
  if (name != kFactory) {
    auto read = read_backup(name);
    if (!read) return tl::unexpected<Error>(read.error());
    if (read->family != context.profile->family)
      return fail(Errc::refused,
                  fmt::format("{} is of {}, not of {}", name, read->family, context.profile->family),
                  "name the family of the backup with -d when the drive really is one");
    backup = std::move(*read);
  }
  report::List out;
  for (const auto node : context.nodes) {
    const auto expected = backup ? side_of(*backup, std::string(name)) : factory_side(*context.profile, node);
    std::vector<ObjectAddress> objects;
    for (const auto& value : expected.values) objects.push_back(value.first);
    const auto read = session::read_objects(*context.session, node, objects);
    if (!read) {
      context.errors.push_back(read.error());
      continue;
    }
    Side actual{fmt::format("node {}", node), node, {}};
    for (const auto& entry : *read)
      if (entry.bytes) actual.values.emplace(entry.object, *entry.bytes);
    auto comparison = compare(context.profile, expected, actual, true, context.chinese);
    if (comparison.different > 0) context.errors.push_back(differences_error(comparison, expected, actual));
    report::Record record{{"node", node}};
    for (auto& field : comparison.record) record.push_back(std::move(field));
    out.emplace_back(std::move(record));
  }
  return Value(std::move(out));
}

}  // namespace

extern const Command kDiff;
const Command kDiff{
    .path = "diff",
    .summary = "Compare two backups, or one with the factory values",
    .details =
        "Shows every value that differs, with unit and label; exit code 1 when there is one. `factory` "
        "stands for the "
        "defaults of the family's data; values whose default the manual does not state are not compared with "
        "it.",
    .parameters = kDiffParameters,
    .needs = Needs::nothing,
    .effect = Effect::none,
    .run = run_diff,
};

extern const Command kVerify;
const Command kVerify{
    .path = "verify",
    .summary = "Compare a drive with a backup or the factory values",
    .details =
        "Reads every value of the backup from the drive; exit code 1 when one differs or is not there.",
    .parameters = kVerifyParameters,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::reads,
    .run = run_verify,
};

}  // namespace servoctl::commands
