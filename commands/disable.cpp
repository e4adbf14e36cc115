#include <fmt/format.h>

#include "commands/command.hpp"
#include "commands/records.hpp"
#include "drive/cia402.hpp"
#include "session/power.hpp"

namespace servoctl::commands {
namespace {

using report::Show;
using report::Value;

report::Table state_table() {
  report::Table table;
  table.columns = {{"node"}, {"state"}, {"energised", "", Show::json}, {"result"}, {"error", "", Show::json}};
  return table;
}

using Action = Result<void> (session::Power::*)();

/// All nodes are told, whatever becomes of the others.
Result<Value> run(Context& context, Action action, std::string_view done_word) {
  auto table = state_table();
  const drive::Profile plain;
  const auto& profile = context.profile != nullptr ? *context.profile : plain;
  for (const auto node : context.nodes) {
    if (context.dry_run) {
      table.rows.push_back({node, Value(), Value(), fmt::format("would be {}", done_word), Value()});
      continue;
    }
    session::Power power(*context.session, profile, node);
    const auto done = (power.*action)();
    const auto state = power.state();
    if (!done) context.errors.push_back(done.error());
    const bool energised = !state || drive::is_energised(*state);
    table.rows.push_back({node, state ? Value(drive::name(*state)) : Value(), Value(energised),
                          done ? Value(done_word) : Value("failed"),
                          done ? Value() : error_record(done.error())});
    if (energised)
      context.notices.push_back(
          state ? fmt::format("node {} is still energised: {}; `disable` takes its power away", node,
                              drive::name(*state))
                : fmt::format("WHETHER NODE {} IS ENERGISED IS NOT KNOWN: TAKE THE POWER AWAY", node));
  }
  return Value(std::move(table));
}

Result<Value> run_disable(Context& context, const Arguments&) {
  return run(context, &session::Power::disable, "disabled");
}
Result<Value> run_quick_stop(Context& context, const Arguments&) {
  return run(context, &session::Power::quick_stop, "stopped");
}

}  // namespace

extern const Command kDisable;
const Command kDisable{
    .path = "disable",
    .summary = "Take the power of a motor away",
    .details =
        "Controlwords 07h and 00h; asks nothing. A motor that turns coasts, or ramps down where the drive "
        "does that by "
        "605Ch; `quick-stop` stops it first. The answer is the state read afterwards.",
    .parameters = {},
    .needs = Needs::node,
    .effect = Effect::writes,
    .family = FamilyCheck::never,
    .run = run_disable,
};

extern const Command kQuickStopCommand;
const Command kQuickStopCommand{
    .path = "quick-stop",
    .summary = "Stop a motor as fast as it can",
    .details =
        "Controlword 02h to every node that is energised; asks nothing. What the drive does after it has "
        "stopped is "
        "set by 605Ah: some stay energised, and the answer says so.",
    .parameters = {},
    .needs = Needs::node,
    .effect = Effect::writes,
    .family = FamilyCheck::never,
    .run = run_quick_stop,
};

}  // namespace servoctl::commands
