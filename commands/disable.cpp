#include <fmt/format.h>

#include "command/command.hpp"
#include "drive/cia402.hpp"
#include "motion/power.hpp"
#include "show/planned_messages.hpp"
#include "show/records.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Show;
using report::Value;

report::Table state_table() {
  report::Table table;
  table.columns = {{"node"}, {"state"}, {"energised", "", Show::json}, {"result"}, {"error", "", Show::json}};
  return table;
}

/// What is known of one node now goes into the table and beside it.
void tell_power_off(Context& context, std::uint8_t node, const motion::PowerDownResult& done,
                    std::string_view done_word, report::Table& table) {
  if (!done.outcome) context.errors.push_back(done.outcome.error());
  const bool energised = !done.statusword || drive::is_energised(done.state());
  table.rows.push_back({node, done.statusword ? Value(drive::name(done.state())) : Value(), Value(energised),
                        done.outcome ? Value(done_word) : Value("failed"),
                        done.outcome ? Value() : show::error_record(done.outcome.error())});
  for (const auto& note : done.notes) context.notices.push_back(fmt::format("node {}: {}", node, note));
  if (energised)
    context.notices.push_back(
        done.statusword
            ? fmt::format("node {} is still energised: {}; `disable` de-energises it", node,
                          drive::name(done.state()))
            : fmt::format("NODE {} MAY BE ENERGISED, STATE UNKNOWN: SWITCH OFF THE SUPPLY", node));
}

Value planned_disable(const Context& context, motion::PowerAim aim) {
  std::vector<session::PlannedMessage> messages;
  for (const auto node : context.nodes)
    for (auto& message : motion::planned_power_down(node, aim)) messages.push_back(std::move(message));
  return show::planned_messages(context, messages);
}

/// All nodes are told at the same time, whatever becomes of the others.
Result<Value> power_down(Context& context, motion::PowerAim aim, std::string_view done_word) {
  if (context.dry_run) return planned_disable(context, aim);
  auto table = state_table();
  std::vector<motion::PowerDownPlan> plans;
  for (const auto node : context.nodes) {
    plans.emplace_back();
    plans.back().node = node;
    plans.back().aim = aim;
  }
  const auto done = motion::take_down(*context.session, plans);
  for (std::size_t i = 0; i < plans.size(); ++i)
    tell_power_off(context, plans[i].node, done[i], done_word, table);
  return Value(std::move(table));
}

Result<Value> run_disable(Context& context, const Arguments&) {
  return power_down(context, motion::PowerAim::disable, "disabled");
}
Result<Value> run_quick_stop(Context& context, const Arguments&) {
  return power_down(context, motion::PowerAim::stop, "stopped");
}

constexpr Example kDisableExamples[] = {
    {"disable -n 1", "de-energise a drive; nothing is asked"},
    {"disable -n all", "every drive that answers"},
};
constexpr Example kQuickStopExamples[] = {
    {"quick-stop -n 1", "stop a motor; `disable` de-energises it"},
    {"quick-stop -n all", "every drive that answers, before waiting for any"},
};

}  // namespace

extern const Command kDisable;
const Command kDisable{
    .path = "disable",
    .summary = "De-energise (disable) a drive",
    .details =
        "Sends controlwords 07h and 00h to all nodes at the same time, without asking. 00h is written in "
        "every state, even Fault. A turning motor coasts, or ramps down if 605Ch says so; use `quick-stop` "
        "first to stop it. A drive that does not obey or answer is also sent NMT pre-operational. The result "
        "is the state read afterwards. Over EtherCAT a drive that `state op` took to OP is in OP behind it, its outputs "
        "preset anew; any other goes back to PRE-OP.",
    .parameters = {},
    .examples = kDisableExamples,
    .needs = Needs::node,
    .effect = Effect::writes,
    .family = FamilyCheck::never,
    .run = run_disable,
};

extern const Command kQuickStopCommand;
const Command kQuickStopCommand{
    .path = "quick-stop",
    .summary = "Stop a motor by quick stop",
    .details =
        "Sends controlword 02h to all nodes before waiting for any answer, without asking. 605Ah sets what a "
        "drive does once stopped: some stay energised, and the result says so.",
    .parameters = {},
    .examples = kQuickStopExamples,
    .needs = Needs::node,
    .effect = Effect::writes,
    .family = FamilyCheck::never,
    .run = run_quick_stop,
};

}  // namespace servoctl::commands
