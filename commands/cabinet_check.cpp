#include "cabinet/cabinet_check.hpp"
#include "cabinet/axis_sheet.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <iterator>

#include "base/text.hpp"
#include "command/command.hpp"

namespace servoctl::commands {
namespace {

using namespace command;
using report::Value;

constexpr Parameter kCabinetCheckParameters[] = {
    {.name = "file", .help = "the cabinet file (default: as --cabinet)", .kind = Kind::file},
};

report::Table axes_checked(const cabinet::Cabinet& cabinet) {
  report::Table out;
  out.columns = {{"axis"},
                 {"bus"},
                 {"node"},
                 {"family"},
                 {"load"},
                 {"pdos"},
                 {"heartbeat_ms", "heartbeat ms"},
                 {"parameters"},
                 {"groups", {}, report::Show::json}};
  for (const auto& axis : cabinet.axes) {
    report::List groups(axis.groups.begin(), axis.groups.end());
    const auto ms =
        axis.heartbeat ? Value(std::chrono::duration_cast<std::chrono::milliseconds>(*axis.heartbeat).count())
                       : Value();
    out.rows.push_back({axis.name, axis.bus, axis.node, axis.family,
                        report::text_or_null(cabinet::load_text(axis)), cabinet::pdos_text(axis), ms,
                        axis.parameters.size(), std::move(groups)});
  }
  return out;
}

Result<Value> run_cabinet_check(Context& context, const Arguments& arguments) {
  const auto file = arguments.text("file");
  auto given = file.empty() ? Result<cabinet::Cabinet>() : cabinet::read_cabinet(std::string(file));
  if (!given) return fail(given.error());
  const auto found = file.empty() ? context.front_end->cabinet() : Result<const cabinet::Cabinet*>(&*given);
  if (!found) return fail(found.error());
  auto findings = cabinet::check_cabinet(
      **found, [&](const std::string& family) { return context.front_end->family(family); });
  std::move(findings.errors.begin(), findings.errors.end(), std::back_inserter(context.errors));
  std::move(findings.notices.begin(), findings.notices.end(), std::back_inserter(context.notices));
  return Value(axes_checked(**found));
}

constexpr Example kCabinetCheckExamples[] = {
    {"cabinet check", "cabinet.toml here or above; no bus is needed"},
    {"cabinet check cell/cabinet.toml", "another file"},
};

}  // namespace

extern const Command kCabinetCheck;
const Command kCabinetCheck{
    .path = "cabinet check",
    .summary = "Check a cabinet file without a bus",
    .details =
        "Reads cabinet.toml and holds every axis against the data of its family: names and values of "
        "parameters with their units and limits, two values for one object, PDOs, heartbeat, units of "
        "limits. Every fault has file, line and column, and one that many axes share is told once. Shows "
        "what each axis is. Nothing is sent.",
    .parameters = kCabinetCheckParameters,
    .examples = kCabinetCheckExamples,
    .needs = Needs::nothing,
    .effect = Effect::none,
    .run = run_cabinet_check,
};

}  // namespace servoctl::commands
