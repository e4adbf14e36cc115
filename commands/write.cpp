#include "command/command.hpp"
#include "command/setting_options.hpp"
#include "command/transfer_option.hpp"
#include "command/type_option.hpp"
#include "settings/change.hpp"
#include "settings/file_transfer.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr std::string_view kPath = "write";

constexpr Parameter kWriteParameters[] = {
    {.name = "object",
     .help = "0x6060, 6099h.1, modes_of_operation, Pn0202",
     .kind = Kind::object,
     .required = true},
    {.name = "value", .help = "100, -5, 0x64, 60rpm, a label, \"text\", hex:00 64", .kind = Kind::value},
    {.name = "--type",
     .help = "data type, if the dictionary does not have it",
     .kind = Kind::type,
     .choices = kTypeNames},
    {.name = "--from", .help = "write the bytes of this file instead of a value", .kind = Kind::file},
    kTransferOption,
    kKeepOption,
    kUnlockOption,
};

Result<void> check_one_source(const Arguments& arguments) {
  if (arguments.has("--from") && arguments.has("--type"))
    return fail(Errc::usage, "--type is for a value; a file is written as raw bytes", "leave --type out");
  if (arguments.has("value") != arguments.has("--from")) return {};
  return fail(Errc::usage, "'write' needs a value, or a file with --from",
              "write OBJECT VALUE, or write OBJECT --from FILE");
}

Result<settings::Change> change_of(Context& context, const Arguments& arguments, std::uint8_t node,
                                   const drive::Target& target, std::optional<od::DataType> type) {
  auto change = arguments.has("--from")
                    ? settings::change_from_file(context.profile, node, target, arguments.text("--from"))
                    : settings::make_change(context, node, target, arguments.text("value"), type);
  if (!change) return change;
  const auto transfer = write_transfer(context, arguments, change->data.size());
  if (!transfer) return fail(show::located(transfer.error(), node, target.address));
  change->transfer = *transfer;
  return change;
}

Result<void> check_write(Context& context, const Arguments& arguments) {
  const auto type = parse_type_option(arguments);
  if (!type) return fail(type.error());
  if (const auto one = check_one_source(arguments); !one) return one;
  const auto target = drive::resolve(context.profile, arguments.text("object"));
  if (!target) return fail(target.error());
  if (arguments.has("--from")) return {};
  for (const auto node : context.nodes)
    if (const auto fits = settings::check_change(context, node, *target, arguments.text("value"), *type);
        !fits)
      return fits;
  return {};
}

Result<report::Value> run_write(Context& context, const Arguments& arguments) {
  const auto type = parse_type_option(arguments);
  if (!type) return fail(type.error());
  if (const auto one = check_one_source(arguments); !one) return fail(one.error());
  const auto target = drive::resolve(context.profile, arguments.text("object"));
  if (!target) return fail(target.error());
  std::vector<settings::Change> changes;
  for (const auto node : context.nodes) {
    auto change = change_of(context, arguments, node, *target, *type);
    if (!change) return fail(change.error());
    changes.push_back(std::move(*change));
  }
  const settings::WriteOptions options{
      .read_back = false, .keep = arguments.has("--keep"), .unlock = arguments.has("--unlock")};
  if (context.dry_run) return settings::planned_changes(context, changes, options);
  if (const auto confirmed = settings::confirm_changes(context, changes); !confirmed)
    return fail(confirmed.error());
  return arguments.has("--from")
             ? settings::write_from_file(context, changes, arguments.text("--from"), options)
             : settings::write_changes(context, changes, options);
}

Result<std::vector<settings::NamedValue>> object_values(const Arguments& arguments) {
  if (!arguments.has("value")) return settings::writes_no_value(kPath);
  return std::vector<settings::NamedValue>{{.name = std::string(arguments.text("object")),
                                            .value = std::string(arguments.text("value")),
                                            .type = od::parse_data_type(arguments.text("--type"))}};
}

constexpr Example kWriteExamples[] = {
    {"write 0x6080 120rpm --keep -n 1 -d dm", "a value with its unit, read back, and kept over power-off"},
    {"write 6060h pv -n 1 -d gsd600 --dry-run", "a label for its number; only show the frames"},
    {"write 0x1017 500 --type u16 -n 1", "without a family: raw number and type"},
};

}  // namespace

extern const Command kWrite;
const Command kWrite{
    .path = kPath,
    .summary = "Write one object of a node",
    .details =
        "The value is checked against type and limits before anything is written. A plain number is the raw "
        "number the drive shows; a number with a unit is converted. A write is never repeated: if its answer "
        "is lost, the object is read and the outcome reported. Asks before a write that stores or restores "
        "parameters, changes node-ID or bitrate, or enables the drive by the controlword. With --from a file "
        "of any size is written, by block transfer if the drive supports it; --keep keeps it too. A COB-ID "
        "that CiA 301 reserves for another service (NMT, SYNC, EMCY, SDO, error control, restricted) is "
        "refused. A value that begins with - and is not a number goes after --: write 0x2000 -- \"--text\".",
    .parameters = kWriteParameters,
    .examples = kWriteExamples,
    .needs = Needs::node,
    .effect = Effect::writes,
    .run = run_write,
    .check = check_write,
    .settings = object_values,
    .on_registers = true,
};

}  // namespace servoctl::commands
