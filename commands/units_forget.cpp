#include <fmt/format.h>

#include "command/command.hpp"
#include "motion/kept_turn.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Show;
using report::Value;

Result<Value> run_units_forget(Context& context, const Arguments& /*unused*/) {
  report::Table table;
  table.columns = {
      {"node"}, {"text", "kept counts per revolution", Show::text}, {"forgotten", "", Show::json}};
  for (const auto node : context.nodes) {
    const motion::TurnFile file(context, node);
    std::error_code error;
    const bool there = !file.path().empty() && std::filesystem::exists(file.path(), error);
    const auto removed = context.dry_run ? Result<bool>(false) : file.remove();
    if (!removed) context.errors.push_back(removed.error());
    const bool gone = removed && *removed;
    table.rows.push_back({node,
                          gone                       ? "forgotten"
                          : there && context.dry_run ? "would be forgotten"
                          : there                    ? "still there"
                                                     : "none were kept",
                          gone});
  }
  return Value(std::move(table));
}

constexpr Example kUnitsForgetExamples[] = {
    {"units forget -n 1", "what `units learn` has kept for node 1 of this bus"},
};

}  // namespace

extern const Command kUnitsForget;
const Command kUnitsForget{
    .path = "units forget",
    .summary = "Delete the kept counts per revolution",
    .details =
        "For these nodes on this bus, whatever drive is there now. Nothing is read from the drive or "
        "changed in it.",
    .parameters = {},
    .examples = kUnitsForgetExamples,
    .needs = Needs::node,
    .effect = Effect::none,
    .run = run_units_forget,
};

}  // namespace servoctl::commands
