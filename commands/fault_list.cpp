#include <fmt/format.h>

#include "commands/command.hpp"
#include "commands/records.hpp"

namespace servoctl::commands {
namespace {

using report::Show;
using report::Value;

constexpr Parameter kParameters[] = {
    {.name = "pattern", .help = "a code (0x8130, AL.28) or a word", .kind = Kind::text},
};

std::string code_text(const drive::Fault& fault) {
  return fault.code ? fmt::format("0x{:04X}", *fault.code) : std::string();
}

bool wanted(const drive::Fault& fault, std::string_view pattern) {
  for (const auto& text : {code_text(fault), fault.extra, fault.panel, fault.name, fault.name_zh})
    if (contains_nocase(text, pattern)) return true;
  return false;
}

Result<report::Value> run(Context& context, const Arguments& arguments) {
  report::Table table;
  table.columns = {{"code_text", "code", Show::text},
                   {"code", "", Show::json},
                   {"extra", "", Show::json},
                   {"panel"},
                   {"kind"},
                   {"name_text", "name", Show::text},
                   {"name", "", Show::json},
                   {"name_zh", "", Show::json},
                   {"resettable"},
                   {"check_text", "check", Show::text},
                   {"check", "", Show::json},
                   {"check_zh", "", Show::json},
                   {"assumed", "", Show::json}};
  const auto pattern = arguments.text("pattern");
  for (const auto& f : context.profile->faults) {
    if (!wanted(f, pattern)) continue;
    const auto shown = context.chinese && !f.name_zh.empty() ? f.name_zh : f.name;
    const auto check = context.chinese && !f.check_zh.empty() ? f.check_zh : f.check;
    table.rows.push_back({code_text(f), f.code ? Value(*f.code) : Value(), report::text_or_null(f.extra),
                          report::text_or_null(f.panel), drive::name(f.kind), shown, f.name,
                          report::text_or_null(f.name_zh), f.resettable ? Value(*f.resettable) : Value(),
                          check, report::text_or_null(f.check), report::text_or_null(f.check_zh),
                          !f.assumed.empty()});
  }
  if (table.rows.empty())
    return fail(Errc::negative, fmt::format("no fault of {} fits '{}'", context.profile->family, pattern),
                "`fault list` shows all");
  return report::Value(std::move(table));
}

}  // namespace

extern const Command kFaultList;
const Command kFaultList{
    .path = "fault list",
    .summary = "List the faults and warnings of a drive family",
    .details = "Works without a bus. The code is the one of object 603Fh and of emergency messages.",
    .parameters = kParameters,
    .needs = Needs::dictionary,
    .effect = Effect::none,
    .run = run,
};

}  // namespace servoctl::commands
