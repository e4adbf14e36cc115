
#include "base/format.hpp"
#include "command/command.hpp"
#include "show/fault_records.hpp"
#include "show/records.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kFaultListParameters[] = {
    {.name = "pattern", .help = "a code (0x8130, AL.28) or a word", .kind = Kind::text},
};

std::string listed_code(const drive::Fault& fault) {
  return fault.code ? formatted("0x{:04X}", *fault.code) : std::string();
}

bool wanted_fault(const drive::Fault& fault, std::string_view pattern) {
  for (const auto& text : {listed_code(fault), fault.extra, fault.panel, fault.name, fault.name_zh})
    if (show::contains_nocase(text, pattern)) return true;
  return false;
}

Result<report::Value> run_fault_list(Context& context, const Arguments& arguments) {
  std::vector<const drive::Fault*> found;
  const auto pattern = arguments.text("pattern");
  for (const auto& fault : context.profile->faults)
    if (wanted_fault(fault, pattern)) found.push_back(&fault);
  if (found.empty())
    return fail(Errc::negative,
                message("no fault of {} matches '{}'", as_it_is(context.profile->family), as_it_is(pattern)),
                "`fault list` shows all");
  if (found.size() > show::kFewFaults) return report::Value(show::fault_table(found, context.chinese));
  report::List out;
  for (const auto* fault : found) out.emplace_back(show::fault_record(*fault, context.chinese));
  return report::Value(std::move(out));
}

constexpr Example kFaultListExamples[] = {
    {"fault list -d ts", "all of the family"},
    {"fault list Er02 -d da200", "those with this in the panel's text"},
    {"fault list 0x8130 -d gsd600", "by the code of 603Fh or an emergency"},
};

}  // namespace

extern const Command kFaultList;
const Command kFaultList{
    .path = "fault list",
    .summary = "List the faults and warnings of a drive family",
    .details =
        "Works without a bus. The code is that of object 603Fh and of emergency messages. `?` marks what the "
        "manual does not state, `!` what it states inconsistently; --json gives the line numbers.",
    .parameters = kFaultListParameters,
    .examples = kFaultListExamples,
    .needs = Needs::dictionary,
    .effect = Effect::none,
    .run = run_fault_list,
};

}  // namespace servoctl::commands
