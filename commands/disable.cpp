
#include <algorithm>
#include <map>

#include "base/format.hpp"
#include "canopen/node_list.hpp"
#include "command/command.hpp"
#include "drive/cia402.hpp"
#include "motion/other_axes.hpp"
#include "motion/power.hpp"
#include "session/option_scope.hpp"
#include "show/planned_messages.hpp"
#include "show/records.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Show;
using report::Value;

report::Table state_table() {
  report::Table table;
  table.columns = {{"node"},
                   {"state"},
                   {"had_power", "", Show::json},
                   {"energised", "", Show::json},
                   {"result", "", Show::json},
                   {"result_text", "result", Show::text},
                   {"error", "", Show::json}};
  return table;
}

constexpr std::string_view kDeEnergised = "de-energised";

/// Nothing was stopped, or disabled, where nothing had power.
std::string_view result_text(const motion::PowerDownResult& done, std::string_view done_word) {
  if (!done.outcome) return "failed";
  // True of it whether or not it was energised before, which nothing tells behind a quick stop.
  if (done_word == kDeEnergised) return done_word;
  if (done.had_power() == false) return "it was already disabled (power stage off; mains may be live)";
  const bool is_stop = done.quick_stop;
  return is_stop && done.is_without_power() && !done.had_power()
             ? "it is disabled (power stage off; mains may be live)"
             : done_word;
}

/// What is known of one node now goes into the table and beside it.
void tell_power_off(Context& context, std::uint8_t node, const motion::PowerDownResult& done,
                    motion::PowerAim aim, std::string_view done_word, report::Table& table) {
  if (!done.outcome) context.errors.push_back(done.outcome.error());
  const bool energised = !done.statusword || drive::is_energised(done.state());
  const auto had_power = done.had_power();
  table.rows.push_back({node, done.statusword ? Value(drive::name(done.state())) : Value(),
                        had_power ? Value(*had_power) : Value(), Value(energised),
                        done.outcome ? Value(done_word) : Value("failed"),
                        Value(result_text(done, done_word)),
                        done.outcome ? Value() : show::error_record(done.outcome.error())});
  for (const auto& note : done.notes)
    context.notices.push_back(message("node {}: {}", node_name(node), note));
  if (energised)
    context.notices.push_back(
        done.statusword
            ? message("node {} is still energised: {}; {}", node_name(node), drive::name(done.state()),
                      aim == motion::PowerAim::disable ? "repeat `disable`, or switch off the supply"
                                                       : "`disable` de-energises it")
            : message("NODE {} MAY BE ENERGISED, STATE UNKNOWN: SWITCH OFF THE SUPPLY", node));
}

/// The end state of a node is that of all its axes.
void stop_other_axes(Context& context, std::uint8_t node, motion::PowerAim aim) {
  const session::Deaf deaf(*context.session);
  auto others = motion::other_axes(*context.session, context.profile, node);
  if (others.empty()) return;
  if (const auto stopped =
          motion::stop_axes(*context.session, node, others, aim == motion::PowerAim::disable);
      !stopped)
    context.errors.push_back(stopped.error());
  for (const auto& axis : others)
    context.notices.push_back(message("node {}: {}", node_name(node), axis.text()));
}

Value planned_disable(Context& context, motion::PowerAim aim) {
  std::vector<session::PlannedMessage> messages;
  for (const auto node : context.nodes)
    for (auto& message : motion::planned_power_down(node, aim)) messages.push_back(std::move(message));
  return show::planned_messages(context, messages);
}

/// Whether something tells that there is a drive of this number, although it may answer nothing.
bool is_known(session::Session& session, std::uint8_t node) {
  const auto& heard = session.network().records();
  return session.energised().contains(node) || heard.state(node) || heard.boots(node) > 0 ||
         heard.heartbeats(node) > 0 || !heard.emergencies(node).empty();
}

/// The nodes of the line; of `all` every number there is, those first of which something is known.
std::vector<std::uint8_t> nodes_to_reach(Context& context) {
  if (context.nodes.front() != 0) return context.nodes;
  auto out = canopen::every_node_id();
  std::stable_partition(out.begin(), out.end(), [&](auto node) { return is_known(*context.session, node); });
  return out;
}

/// All nodes are told at the same time, whatever becomes of the others.
Result<Value> power_down(Context& context, motion::PowerAim aim, std::string_view done_word) {
  if (context.dry_run) return planned_disable(context, aim);
  const bool reaches_all = context.nodes.front() == 0;
  std::vector<motion::PowerDownPlan> plans;
  for (const auto node : nodes_to_reach(context)) {
    plans.emplace_back();
    plans.back().node = node;
    plans.back().aim = aim;
    plans.back().may_be_absent = reaches_all && !is_known(*context.session, node);
  }
  const auto done = motion::take_down(*context.session, plans);
  std::map<std::uint8_t, const motion::PowerDownResult*> there;
  for (std::size_t i = 0; i < plans.size(); ++i)
    if (!reaches_all || !done[i].silent || is_known(*context.session, plans[i].node))
      there.emplace(plans[i].node, &done[i]);
  if (there.empty())
    return fail(
        Errc::timeout, message("no node answered on {}", as_it_is(context.session->url())),
        "drives that are energised there stay so: switch off the supply; then check cable, termination and bitrate");
  auto table = state_table();
  context.nodes.clear();
  for (const auto& [node, result] : there) {
    context.nodes.push_back(node);
    tell_power_off(context, node, *result, aim, done_word, table);
    if (!result->silent) stop_other_axes(context, node, aim);
  }
  return Value(std::move(table));
}

Result<Value> run_disable(Context& context, const Arguments&) {
  return power_down(context, motion::PowerAim::disable, "disabled");
}
Result<Value> run_quick_stop(Context& context, const Arguments&) {
  return power_down(context, motion::PowerAim::stop, "stopped");
}

/// What was energised here is stopped whether or not it is among the axes of a cabinet file.
Result<Value> run_stop(Context& context, const Arguments&) {
  auto& nodes = context.nodes;
  const bool means_all = !context.nodes_typed && nodes.front() != 0;
  for (const auto node : context.session->energised().nodes())
    if (means_all && std::find(nodes.begin(), nodes.end(), node) == nodes.end()) nodes.push_back(node);
  return power_down(context, motion::PowerAim::stop_and_disable, kDeEnergised);
}

constexpr Example kStopExamples[] = {
    {"stop", "everything: every drive of the bus, or every axis of the cabinet file"},
    {"stop -n 1,3", "these drives alone"},
};
constexpr Example kDisableExamples[] = {
    {"disable -n 1", "de-energise a drive; nothing is asked"},
    {"disable -n all", "every drive of the bus, those that answer nothing too"},
};
constexpr Example kQuickStopExamples[] = {
    {"quick-stop -n 1", "stop a motor; `disable` de-energises it"},
    {"quick-stop -n all", "every drive of the bus, before waiting for any"},
};

}  // namespace

extern const Command kDisable;
const Command kDisable{
    .path = "disable",
    .summary = "De-energise (disable) a drive",
    .details =
        "Sends controlwords 07h and 00h to all nodes at the same time, without asking. 00h is written in "
        "every state, even Fault. A turning motor coasts, or ramps down if 605Ch says so; use `quick-stop` "
        "first to stop it. A drive that does not obey or answer is also sent NMT pre-operational. On CAN "
        "-n all goes to all 127 node-IDs; with a cabinet file in use it is the axes of that. The result is the state "
        "read afterwards. Over EtherCAT a drive that `state op` took to OP is in OP behind it, its outputs "
        "preset anew; any other goes back to PRE-OP.",
    .parameters = {},
    .examples = kDisableExamples,
    .needs = Needs::node,
    .effect = Effect::writes,
    .family = FamilyCheck::never,
    .run = run_disable,
    .to_silent = true,
    .way_out = true,
};

extern const Command kQuickStopCommand;
const Command kQuickStopCommand{
    .path = "quick-stop",
    .summary = "Stop a motor by quick stop",
    .details =
        "Sends controlword 02h to all nodes before waiting for any answer, without asking. A drive that does not "
        "answer is also sent NMT pre-operational. On CAN -n all goes to all 127 node-IDs; with a cabinet file in use "
        "it is the axes of that. 605Ah sets how a drive stops, and what it does then: some stay energised, and the "
        "result says so.",
    .parameters = {},
    .examples = kQuickStopExamples,
    .needs = Needs::node,
    .effect = Effect::writes,
    .family = FamilyCheck::never,
    .run = run_quick_stop,
    .to_silent = true,
    .way_out = true,
};

extern const Command kStop;
const Command kStop{
    .path = "stop",
    .summary = "Stop and de-energise every drive",
    .details =
        "Quick stop, then disable: sends controlword 02h to all nodes before waiting for any answer, and 07h and 00h "
        "as soon as a drive has stopped, without asking. Without -n it is -n all, whatever `use` says: on CAN all "
        "127 node-IDs, with a cabinet file in use its axes on all their buses, and every drive that was energised "
        "here. A drive that does not obey or answer is also sent NMT pre-operational. Over EtherCAT every slave "
        "goes to PRE-OP. The result is the state read afterwards.",
    .parameters = {},
    .examples = kStopExamples,
    .needs = Needs::node,
    .effect = Effect::writes,
    .family = FamilyCheck::never,
    .run = run_stop,
    .to_silent = true,
    .way_out = true,
    .all_by_default = true,
};

}  // namespace servoctl::commands
