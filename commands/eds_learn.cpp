#include "base/format.hpp"
#include "command/command.hpp"
#include "command/output_form.hpp"
#include "command/standard_scope.hpp"
#include "settings/learning.hpp"
#include "settings/scan_ranges.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kEdsLearnParameters[] = {
    {.name = "--output",
     .help = "the EDS file to write",
     .kind = Kind::file,
     .required = true,
     .short_name = "-o"},
    {.name = "--range",
     .help = "indexes to scan: 2000-2FFF,6000-67FF (default: 1000-67FF and each axis there is)",
     .kind = Kind::text},
    {.name = "--scan",
     .help = "read index by index even if the drive stores an EDS or describes its objects",
     .kind = Kind::flag},
    {.name = "--despite-alarms",
     .help =
         "scan although the drive raises alarms for objects that it does not have: it is in fault afterwards",
     .kind = Kind::flag},
};

Result<report::Value> run_eds_learn(Context& context, const Arguments& arguments) {
  settings::LearnOptions options{.scans = arguments.has("--scan"),
                                 .despite_alarms = arguments.has("--despite-alarms")};
  if (arguments.has("--range")) {
    auto ranges = settings::parse_ranges(arguments.text("--range"));
    if (!ranges) return fail(ranges.error());
    options.ranges = std::move(*ranges);
    options.scans = true;
    if (!arguments.has("--scan"))
      context.notices.push_back("--range scans the drive: the EDS that it may store (1021h) is not read");
  }
  if (is_output_form(arguments.text("--output")))
    return fail(Errc::usage,
                message("'{}' is an output format, and no file", as_it_is(arguments.text("--output"))),
                "name the file: -o drive.eds");
  if (context.nodes.size() != 1)
    return fail(Errc::usage, "eds learn takes one node: a file is of one drive", "name one with --node");
  const StandardScope standard(context);
  auto learned =
      settings::learn_sheet(context, context.nodes.front(), std::string(arguments.text("--output")), options);
  if (!learned) return fail(learned.error());
  return report::Value(std::move(*learned));
}

constexpr Example kEdsLearnExamples[] = {
    {"eds learn -o drive.eds -n 1", "an EDS of a drive that nobody has one for"},
    {"eds learn -o drive.eds --range 2000-2FFF,6000-67FF -n 1", "only these indexes"},
};

}  // namespace

extern const Command kEdsLearn;
const Command kEdsLearn{
    .path = "eds learn",
    .summary = "Write an EDS of a drive from what the drive itself tells",
    .details =
        "Takes the EDS that the drive stores (1021h, up to 4 MiB) or, on EtherCAT, what it describes (SDO "
        "information). Otherwise it scans: it reads sub-index 0 of each index, then the sub-indices of what is "
        "there. That shows sizes and what is write-only. Names, types and access of standard objects are those "
        "of CiA 301 and CiA 402. Other objects are unsigned and `ro`, because a read shows neither sign nor "
        "write access; a backup saves them nevertheless, and `restore` compares them and writes them only after "
        "AccessType is changed to `rw`. COB-IDs of the predefined connection set are `$NODEID+0x…`. Nothing is "
        "written to the drive. An interrupted scan is "
        "kept in FILE.part, and the same command continues it. A drive is not scanned while an axis is enabled; "
        "an EMCY, a restart or an axis that gets enabled ends the scan. A drive that raises an alarm for objects "
        "which it does not have is refused (--despite-alarms). `eds check` and `eds verify` check the file.",
    .parameters = kEdsLearnParameters,
    .examples = kEdsLearnExamples,
    .needs = Needs::node,
    .effect = Effect::reads,
    .run = run_eds_learn,
    .one_file = "--output",
};

}  // namespace servoctl::commands
