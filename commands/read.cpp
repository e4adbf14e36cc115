#include "command/command.hpp"
#include "command/transfer_option.hpp"
#include "command/type_option.hpp"
#include "settings/file_transfer.hpp"
#include "show/reading.hpp"
#include "show/records.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kParameters[] = {
    {.name = "object",
     .help = "0x6041, 6099h.1, statusword, Pn0202",
     .kind = Kind::object,
     .required = true,
     .many = true},
    {.name = "--type",
     .help = "data type, if the dictionary does not have it",
     .kind = Kind::type,
     .choices = kTypeNames},
    {.name = "--to", .help = "write the bytes of one object to this file", .kind = Kind::file},
    kTransferOption,
};

Result<drive::Target> readable_target(const Context& context, std::uint8_t node, const std::string& word) {
  auto target = drive::resolve(context.profile, word);
  if (target && !od::readable(drive::meaning(*target, node).access))
    return fail(Errc::usage, "'" + word + "' is write-only", "it can be written, not read");
  return target;
}

Result<void> check(Context& context, const Arguments& arguments) {
  if (const auto type = parse_type_option(arguments); !type) return fail(type.error());
  for (const auto node : context.nodes)
    for (const auto& word : arguments.all("object"))
      if (const auto target = readable_target(context, node, word); !target) return fail(target.error());
  return {};
}

/// `--to` takes the bytes of one object of one node.
Result<report::Value> run_to_file(Context& context, const Arguments& arguments) {
  if (arguments.has("--type"))
    return fail(Errc::usage, "--type is for values that are shown; --to writes the raw bytes",
                "leave --type out");
  if (arguments.all("object").size() != 1 || context.nodes.size() != 1)
    return fail(Errc::usage, "--to takes one object of one node",
                "use a separate command and file for each object and node");
  const auto target = drive::resolve(context.profile, arguments.text("object"));
  if (!target) return fail(target.error());
  return settings::read_to_file(context, context.nodes.front(), *target,
                                read_transfer(context, arguments, true), arguments.text("--to"));
}

Result<report::Value> run(Context& context, const Arguments& arguments) {
  if (arguments.has("--to")) return run_to_file(context, arguments);
  const auto type = parse_type_option(arguments);
  if (!type) return fail(type.error());
  std::vector<show::Reading> readings;
  std::vector<session::SdoRequest> requests;
  for (const auto node : context.nodes) {
    for (const auto& word : arguments.all("object")) {
      const auto target = readable_target(context, node, word);
      if (!target) return fail(target.error());
      readings.push_back({node, *target, *type, Bytes{}});
      const auto fixed_size = show::size_of(readings.back());
      const bool large = drive::meaning(*target, node).type == od::DataType::domain;
      requests.push_back({node, target->address, {}, read_transfer(context, arguments, large), fixed_size});
    }
  }
  auto answers = context.session->transfer(requests);
  for (std::size_t i = 0; i < readings.size(); ++i) readings[i].bytes = std::move(answers[i]);
  return report::Value(show::reading_table(context, readings));
}

}  // namespace

extern const Command kRead;
const Command kRead{
    .path = "read",
    .summary = "Read objects of a node",
    .details =
        "Without --drive only addresses are accepted, and the value is shown as an unsigned number of its "
        "length. Index and sub-index are hexadecimal. With --to the bytes of one object of any size go to a "
        "file; block transfer is tried first where the drive may support it.",
    .parameters = kParameters,
    .needs = Needs::node,
    .effect = Effect::reads,
    .run = run,
    .check = check,
};

}  // namespace servoctl::commands
