#include "commands/change.hpp"
#include "commands/type_option.hpp"

namespace servoctl::commands {
namespace {

constexpr Parameter kParameters[] = {
    {.name = "object",
     .help = "0x6060, 6099h.1, modes_of_operation, Pn0202",
     .kind = Kind::object,
     .required = true},
    {.name = "value",
     .help = "100, -5, 0x64, 60rpm, a label, \"text\", hex:00 64",
     .kind = Kind::value,
     .required = true},
    {.name = "--type",
     .help = "data type, when the dictionary does not know it",
     .kind = Kind::type,
     .choices = kTypeNames},
};

Result<report::Value> run(Context& context, const Arguments& arguments) {
  const auto type = parse_type_option(arguments);
  if (!type) return tl::unexpected<Error>(type.error());
  const auto target = drive::resolve(context.profile, arguments.text("object"));
  if (!target) return tl::unexpected<Error>(target.error());
  std::vector<Change> changes;
  for (const auto node : context.nodes) {
    auto change = make_change(context, node, *target, arguments.text("value"), *type);
    if (!change) return tl::unexpected<Error>(change.error());
    changes.push_back(std::move(*change));
  }
  if (context.dry_run) return planned_frames(changes);
  if (const auto confirmed = confirm_changes(context, changes); !confirmed)
    return tl::unexpected<Error>(confirmed.error());
  return write_changes(context, changes, false);
}

}  // namespace

extern const Command kWrite;
const Command kWrite{
    .path = "write",
    .summary = "Write one object of a node",
    .details =
        "The value is checked against type and limits before a frame is sent. A plain number is the raw "
        "number the drive shows; a number with a unit is converted. A write is never repeated: when its "
        "answer is lost, the object is read and the outcome told. Asked before: what stores or restores, "
        "changes node-ID or bitrate, and a controlword that enables the drive.",
    .parameters = kParameters,
    .needs = Needs::node,
    .effect = Effect::writes,
    .run = run,
};

}  // namespace servoctl::commands
