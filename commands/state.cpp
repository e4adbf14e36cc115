#include <fmt/format.h>
#include <array>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/format.hpp"
#include "command/command.hpp"
#include "motion/power_down.hpp"
#include "session/ring_state.hpp"
#include "show/planned_messages.hpp"
#include "show/records.hpp"
#include "show/ring_table.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Show;
using report::Value;
using session::NodeState;

constexpr Parameter kStateParameters[] = {
    {.name = "--take-over",
     .help = "take slaves that another master has left in SAFE-OP or OP; asks first",
     .kind = Kind::flag},
};

std::string list(std::span<const std::uint8_t> nodes) {
  return formatted("node{} {}", nodes.size() == 1 ? "" : "s", fmt::join(nodes, ", "));
}

/// What is still driven by another master is asked for, and what has power among it loses it in good order.
Result<void> take_over(Context& context, session::EtherCatNetwork& ring) {
  const auto foreign = session::foreign_nodes(ring, context.nodes);
  if (!foreign) return fail(foreign.error());
  if (foreign->empty()) return {};
  const auto question = formatted(
      "Take {} over from another master? If that master still runs, both write to it; an energised motor is de-energised and coasts.",
      list(*foreign));
  if (const auto answer = context.confirm(question); !answer) return fail(answer.error());
  std::vector<motion::PowerDownPlan> plans;
  for (const auto node : *foreign) ring.take_over(node);
  for (const auto node : *foreign)
    if (session::has_power(*context.session, node).value_or(false)) plans.push_back({.node = node});
  // Leaving OP takes the power away where this does not.
  for (const auto& done : motion::take_down(*context.session, plans))
    for (const auto& note : done.notes) context.notices.push_back(note);
  return {};
}

Value planned_state(Context& context, NodeState target) {
  std::vector<session::PlannedMessage> messages;
  const auto when = "outputs preset: 607Ah from 6064h, 6040h 60FFh 6071h zero";
  for (const auto node : context.nodes) {
    if (target == NodeState::initialising)
      messages.push_back(session::planned_state(node, target));
    else
      messages.push_back(session::planned_state(node, NodeState::pre_operational));
    if (target == NodeState::safe_operational || target == NodeState::operational)
      messages.push_back(session::planned_state(node, NodeState::safe_operational, when));
    if (target == NodeState::operational) messages.push_back(session::planned_state(node, target));
  }
  return show::planned_messages(context, messages);
}

report::List state_row(std::uint8_t node, const ethercat::AlStatus* al, const Result<void>& done) {
  report::List row{node, al != nullptr ? Value(show::al_text(*al)) : Value()};
  for (auto& field : show::al_fields(al != nullptr ? *al : ethercat::AlStatus{}))
    row.push_back(al != nullptr ? std::move(field.value) : Value());
  row.emplace_back(done ? "reached" : "failed");
  row.push_back(done ? Value() : show::error_record(done.error()));
  return row;
}

Result<Value> run_state(Context& context, const Arguments& arguments, NodeState target) {
  if (context.dry_run) return planned_state(context, target);
  auto& ring = *context.session->ethercat();
  if (arguments.has("--take-over"))
    if (const auto taken = take_over(context, ring); !taken) return fail(taken.error());
  report::Table table;
  table.columns = {{"node"},
                   {"state", "AL state", Show::text},
                   {"al_state", "", Show::json},
                   {"al_error", "", Show::json},
                   {"al_code", "", Show::json},
                   {"al_text", "", Show::json},
                   {"result"},
                   {"error", "", Show::json}};
  for (const auto node : context.nodes) {
    const auto done = session::change_al_state(*context.session, ring, node, target);
    if (!done) context.errors.push_back(done.error());
    if (done && target == NodeState::operational) ring.keep_operational(node);
    table.rows.push_back(state_row(node, ring.al_of(node), done));
  }
  return Value(std::move(table));
}

template <NodeState target>
Result<Value> run_state_command(Context& context, const Arguments& arguments) {
  return run_state(context, arguments, target);
}

constexpr std::string_view kDown =
    "The slave confirms it, or says why not (AL status code). An energised drive is refused, because it "
    "would be de-energised in motion: `disable` it first. With --take-over, slaves that a master which is gone left in "
    "SAFE-OP or OP are taken; asks first, and de-energises them.";

constexpr std::string_view kUp =
    "Its PDOs stay as assigned if they carry controlword and statusword; else those of its family are assigned "
    "until it goes back (-d). Every output is preset from the drive, 607Ah from 6064h and 6040h, 60FFh and 6071h "
    "with 0, so nothing moves; the drive is not enabled. The state is held only as long as servoctl sends "
    "process data: in the prompt and in a batch file to their end, by itself until Ctrl-C. Then the slave goes "
    "back to PRE-OP. With --take-over, slaves that a master which is gone left in SAFE-OP or OP are taken; asks "
    "first, and de-energises them.";

constexpr std::string_view kStateElsewhere =
    "on CAN `nmt start`, `nmt stop` and `nmt preop` change the state of a node";

constexpr Example kStateInitExamples[] = {
    {"state init -n 1 -b coe:eth0", "no objects, no process data"},
    {"state init -n 1 --take-over -b coe:eth0", "a slave that a master left in OP when it went"},
};
constexpr Example kStatePreopExamples[] = {
    {"state preop -n 1 -b coe:eth0", "objects can be read and written; no process data"},
};
constexpr Example kStateSafeopExamples[] = {
    {"state safeop -n 1 -d sv2 -b coe:eth0", "inputs alone are exchanged, until Ctrl-C"},
};
constexpr Example kStateOpExamples[] = {
    {"state op -n 1 -d sv2 -b coe:eth0", "exchange process data until Ctrl-C; the drive is not enabled"},
};

}  // namespace

extern const Command kStateInit;
const Command kStateInit{
    .path = "state init",
    .summary = "Set EtherCAT slaves to INIT: no objects, no process data",
    .details = kDown,
    .parameters = kStateParameters,
    .examples = kStateInitExamples,
    .needs = Needs::node | Needs::ethercat,
    .effect = Effect::writes,
    .family = FamilyCheck::never,
    .run = run_state_command<NodeState::initialising>,
    .way_out = true,
    .elsewhere = kStateElsewhere,
};

extern const Command kStatePreop;
const Command kStatePreop{
    .path = "state preop",
    .summary = "Set EtherCAT slaves to PRE-OP: objects, no process data",
    .details = kDown,
    .parameters = kStateParameters,
    .examples = kStatePreopExamples,
    .needs = Needs::node | Needs::ethercat,
    .effect = Effect::writes,
    .family = FamilyCheck::never,
    .run = run_state_command<NodeState::pre_operational>,
    .way_out = true,
    .elsewhere = kStateElsewhere,
};

extern const Command kStateSafeop;
const Command kStateSafeop{
    .path = "state safeop",
    .summary = "Set EtherCAT slaves to SAFE-OP: inputs only; holds it",
    .details = kUp,
    .parameters = kStateParameters,
    .examples = kStateSafeopExamples,
    .needs = Needs::node | Needs::ethercat,
    .effect = Effect::writes,
    .family = FamilyCheck::never,
    .run = run_state_command<NodeState::safe_operational>,
    .elsewhere = kStateElsewhere,
};

extern const Command kStateOp;
const Command kStateOp{
    .path = "state op",
    .summary = "Set EtherCAT slaves to OP: process data; holds it",
    .details = kUp,
    .parameters = kStateParameters,
    .examples = kStateOpExamples,
    .needs = Needs::node | Needs::ethercat,
    .effect = Effect::writes,
    .family = FamilyCheck::never,
    .run = run_state_command<NodeState::operational>,
    .elsewhere = kStateElsewhere,
};

}  // namespace servoctl::commands
