
#include "base/format.hpp"
#include "command/command.hpp"
#include "command/setting_options.hpp"
#include "settings/comparison.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Value;

constexpr std::string_view kFactoryValues = "factory";

constexpr Parameter kVerifyParameters[] = {
    {.name = "file", .help = "a backup of any format, or factory", .kind = Kind::file, .required = true},
    kSkipInvalidOption,
};

Result<Value> run_verify(Context& context, const Arguments& arguments) {
  const auto name = arguments.text("file");
  std::optional<settings::Backup> backup;
  if (name != kFactoryValues) {
    auto read = settings::read_backup(context, name, context.front_end, context.nodes.front(),
                                      arguments.has("--skip-invalid"));
    if (!read) return fail(read.error());
    if (read->family != context.profile->family)
      return fail(Errc::refused,
                  message("{} is for {}, not for {}", as_it_is(name), as_it_is(read->family),
                          as_it_is(context.profile->family)),
                  "give the backup's family with -d if the drive really is one");
    backup = std::move(*read);
  }
  report::List out;
  for (const auto node : context.nodes) {
    auto expected = backup ? settings::side_of(*backup, std::string(name))
                           : settings::factory_side(*context.profile, node);
    settings::leave_unreachable(context, context.profile, expected);
    std::vector<ObjectAddress> objects;
    for (const auto& value : expected.values) objects.push_back(value.first);
    const auto read = session::read_objects(*context.session, node, objects);
    if (!read) {
      context.errors.push_back(read.error());
      continue;
    }
    settings::Side actual{formatted("node {}", node), node, {}, true};
    for (const auto& entry : *read)
      if (entry.bytes) actual.values.emplace(entry.object, *entry.bytes);
    auto comparison = settings::compare(context.profile, expected, actual, true, context.chinese);
    if (comparison.different > 0)
      context.errors.push_back(settings::differences_error(comparison, expected, actual));
    report::Record record{{"node", node}};
    for (auto& field : comparison.record) record.push_back(std::move(field));
    out.emplace_back(std::move(record));
  }
  return Value(std::move(out));
}

constexpr Example kVerifyExamples[] = {
    {"verify good.json -n 1 -d gsd600", "whether the drive still holds the backup; exit code 1 if not"},
    {"verify factory -n 1 -d gsd600", "whether it is as from the factory"},
};

}  // namespace

extern const Command kVerify;
const Command kVerify{
    .path = "verify",
    .summary = "Compare a drive with a backup or the factory values",
    .details =
        "Reads every value of the backup from the drive; exit code 1 if one differs or is missing. A file in "
        "another format is refused if it has an unusable entry; --skip-invalid verifies the rest, exit code "
        "1.",
    .parameters = kVerifyParameters,
    .examples = kVerifyExamples,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::reads,
    .family = FamilyCheck::always,
    .run = run_verify,
    .on_registers = true,
};

}  // namespace servoctl::commands
