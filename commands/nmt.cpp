#include "canopen/nmt.hpp"
#include "base/format.hpp"

#include <algorithm>

#include "command/command.hpp"
#include "command/nmt_result.hpp"
#include "session/can_network.hpp"
#include "session/gateway_network.hpp"
#include "session/identify.hpp"
#include "session/node_life.hpp"
#include "session/stretch.hpp"
#include "show/owed_restart.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using canopen::NmtCommand;
using report::Value;

constexpr Duration kBootPatience = std::chrono::seconds(5);
/// A node answers node guarding within some milliseconds.
constexpr Duration kGuardPatience = std::chrono::milliseconds(200);
constexpr Duration kStatePatience = std::chrono::seconds(2);

constexpr Parameter kNmtParameters[] = {
    {.name = "--wait",
     .help = "wait until a heartbeat or the boot-up message confirms it",
     .kind = Kind::flag},
};

using Before = session::NodeLife;

Result<void> wait_for_boots(session::Session& session, std::span<const Before> nodes) {
  const auto all = [&] {
    return std::ranges::all_of(
        nodes, [&](const Before& one) { return session.watch().boots(one.node) > one.boots; });
  };
  const auto waited = session.wait(all, session.now() + kBootPatience);
  return waited ? Result<void>() : fail(waited.error());
}

/// After a reset of all nodes: what waited for it is forgotten only where the restart is heard.
Result<void> hear_owed_restarts(const Context& context) {
  auto& session = *context.session;
  const auto owing = show::owing_nodes(context.state_folder, session.url());
  return wait_for_boots(session, session::look_from_now(session, owing));
}

/// After it a drive may do what it did not do before.
bool begins(NmtCommand command) { return is_reset(command) || command == NmtCommand::start; }

void tell_doubled(Context& context, std::span<Before> nodes) {
  for (auto& entry : nodes)
    if (auto single = session::refuse_duplicate(*context.session, entry.node); !single) {
      context.errors.push_back(std::move(single.error()));
      entry.doubled = true;
      entry.alive = false;
    }
}

/// After the command: whether anybody is there at all. Of a stopped node without heartbeat and guarding
/// nothing can be known, so that its silence is no error.
Result<void> look_for_life(Context& context, NmtCommand command, std::vector<Before>& nodes) {
  auto& session = *context.session;
  const bool stops = command == NmtCommand::stop;
  if (!stops && !begins(command))
    if (const auto asked = session::ask_who_answers(session, nodes); !asked) return asked;
  // Over a gateway a node that answers no SDO cannot be heard.
  if (stops && session.can() == nullptr) return {};
  if (is_reset(command))
    if (const auto back = session.can() != nullptr ? wait_for_boots(session, nodes)
                                                   : session::wait_for_answers(session, nodes, kBootPatience);
        !back)
      return back;
  if (begins(command))
    if (const auto looked = session::look_for_second(session, nodes); !looked) return looked;
  if (const auto heard = session::hear_who_lives(session, nodes, kGuardPatience); !heard) return heard;
  // A stopped node is heard to be two only once it has started.
  if (!stops) tell_doubled(context, nodes);
  for (const auto& entry : nodes) {
    if (entry.alive || entry.doubled) continue;
    auto error = drive_error(Errc::timeout, entry.node,
                             message("'{}' was sent, not confirmed: nothing was heard of the node",
                                     as_it_is(canopen::name(command))),
                             "check node-ID, power and cable; `scan` shows who answers");
    if (stops)
      context.notices.push_back(error.message);
    else
      context.errors.push_back(std::move(error));
  }
  return {};
}

report::Value planned_frames(Context& context, NmtCommand command) {
  report::Table table;
  table.columns = {{"node"}, {"frame"}};
  auto* gateway = context.session->gateway();
  for (const auto node : context.nodes)
    table.rows.push_back({node, gateway != nullptr ? gateway->command_line(node, command)
                                                   : can::to_string(canopen::nmt_frame(command, node))});
  if (command == NmtCommand::reset_communication) context.notices.push_back(communication_goes());
  return report::Value(std::move(table));
}

Result<void> send_nmt(session::Session& session, NmtCommand command, std::uint8_t node) {
  if (auto* gateway = session.gateway()) return gateway->command(node, command);
  const auto sent = session.can()->send(canopen::nmt_frame(command, node));
  if (sent) session.can()->watch().on_command(node);
  return sent;
}

Result<void> check_wait(const Context& context, bool wait) {
  if (wait && context.nodes.front() == 0)
    return fail(Errc::usage, "--wait needs node-IDs: `all` does not say which nodes must answer",
                "for example -n 1,2,3");
  if (wait && context.session->gateway() != nullptr)
    return fail(Errc::usage, "--wait needs heartbeats, and a gateway passes on none", "leave --wait out");
  return {};
}

/// Until a heartbeat or a boot-up of each confirms the command.
Result<report::Value> wait_for_all(Context& context, NmtCommand command, std::span<Before> before,
                                   const session::Heartbeats& heartbeats) {
  const auto done = [&] {
    return std::ranges::all_of(before,
                               [&](const Before& b) { return is_confirmed(*context.session, b, command); });
  };
  const bool hopeless = heartbeats.silent.size() == before.size();
  const auto patience = is_reset(command) ? kBootPatience : std::max(kStatePatience, 2 * heartbeats.longest);
  const auto until = context.session->now() + (hopeless ? Duration::zero() : patience);
  const session::Stretch stretch(*context.session, until, session::Stretch::End::at_latest);
  const auto waited = context.session->wait(done, until);
  if (!waited) return fail(waited.error());
  if (begins(command)) {
    if (const auto looked = session::look_for_second(*context.session, before); !looked)
      return fail(looked.error());
    tell_doubled(context, before);
  }
  tell_reset(context, before, command, true);
  for (const auto& entry : before)
    if (!entry.doubled && !is_confirmed(*context.session, entry, command))
      context.errors.push_back(unconfirmed(entry, command, heartbeats, context.session->can()->watch()));
  return report::Value(nmt_table(context, before, command, true));
}

/// In the state stopped a node answers no SDO (CiA 301, 7.3.2.2.1), so that nothing tells one drive from two
/// of its node-ID: their answers to node guarding are the same frame.
Result<void> refuse_stopped(const session::Session& session, const Before& entry) {
  if (entry.answers || session.watch().state(entry.node) != session::NodeState::stopped) return {};
  return fail(drive_error(
      Errc::refused, entry.node,
      "it is stopped (NMT) and answers no SDO, so whether two drives have its node-ID is not known: not reset",
      message("`nmt preop -n {}` first", node_name(entry.node))));
}

/// Whose drives they are is seen before what begins something is sent.
Result<void> look_before(Context& context, NmtCommand command, std::vector<Before>& nodes) {
  auto& session = *context.session;
  if (!begins(command)) return {};
  if (const auto single = session::hold_single(session, nodes); !single) return single;
  if (!is_reset(command)) return {};
  if (const auto heard = session::hear_who_lives(session, nodes, kGuardPatience); !heard) return heard;
  for (const auto& entry : nodes)
    if (const auto may = refuse_stopped(session, entry); !may) return may;
  return {};
}

Result<report::Value> run_nmt(Context& context, const Arguments& arguments, NmtCommand command) {
  if (context.dry_run) return planned_frames(context, command);
  const bool wait = arguments.has("--wait");
  if (const auto may = check_wait(context, wait); !may) return fail(may.error());
  if (is_reset(command))
    if (const auto answer = context.confirm(question_nmt(context.nodes, command)); !answer)
      return fail(answer.error());
  const auto heartbeats = wait && !is_reset(command)
                              ? session::read_heartbeats(*context.session, context.nodes)
                              : session::Heartbeats();
  auto before = session::look_from_now(*context.session, context.nodes);
  const bool named = context.nodes.front() != 0;
  if (named)
    if (const auto looked = look_before(context, command, before); !looked) return fail(looked.error());
  for (auto& entry : before) {
    entry.boots = context.session->watch().boots(entry.node);
    entry.heartbeats = context.session->watch().heartbeats(entry.node);
    if (is_reset(command)) entry.alive = false;
    if (const auto sent = send_nmt(*context.session, command, entry.node); !sent) return fail(sent.error());
  }
  if (!wait) {
    if (named)
      if (const auto looked = look_for_life(context, command, before); !looked) return fail(looked.error());
    if (!named && command == NmtCommand::reset_node)
      if (const auto heard = hear_owed_restarts(context); !heard) return fail(heard.error());
    tell_reset(context, before, command, false);
    return report::Value(nmt_table(context, before, command, false));
  }
  return wait_for_all(context, command, before, heartbeats);
}

template <NmtCommand command>
Result<report::Value> run_nmt_command(Context& context, const Arguments& arguments) {
  return run_nmt(context, arguments, command);
}

constexpr std::string_view kDetails =
    "The command is sent once; nodes do not answer it. Then servoctl looks for a sign of life: a heartbeat, an "
    "answer to node guarding or to an SDO request. Without one the result is \"sent, not confirmed\", with exit "
    "code 4 unless the node was stopped. With --wait it is done when a heartbeat confirms it; exit code 4 if "
    "none does. `-n all` addresses every node, and looks for nobody.";

constexpr std::string_view kStartDetails =
    "The command is sent once; nodes do not answer it. Before it and behind it servoctl asks the node, and listens "
    "a quarter of a second for a second drive of its node-ID: two are an error, exit code 8. Without an answer, a "
    "heartbeat or an answer to node guarding the result is \"sent, not confirmed\", exit code 4. With --wait it is "
    "done when a heartbeat confirms it; exit code 4 if none does. `-n all` addresses every node, and looks for "
    "nobody.";

constexpr std::string_view kNmtElsewhere =
    "the AL state of a slave is changed with `state init`, `state preop`, `state safeop` and `state op`";

constexpr std::string_view kResetDetails =
    "The node restarts as after power-on: settings neither stored (`store`) nor kept (--keep) are lost. A "
    "node-ID that two drives share is refused, and so is a stopped node: it answers no SDO, so that nothing "
    "tells one drive from two. `nmt preop` first. With "
    "--wait it is done when the boot-up message confirms it; exit code 4 if none comes. `-n all` addresses "
    "every node.";

constexpr std::string_view kResetCommDetails =
    "By CiA 301 the node resets 1000h to 1FFFh to their power-on values: PDOs, COB-IDs, its heartbeat "
    "(1017h) and heartbeat consumers (1016h) go back to what is stored. Everything else stays unchanged. "
    "With --wait it is done when the boot-up message confirms it; exit code 4 if none comes. `-n all` "
    "addresses every node.";

constexpr Example kNmtStartExamples[] = {
    {"nmt start -n 1", "PDOs of one node on"},
    {"nmt start -n all", "of every node, by one message"},
    {"nmt start -n 1 --wait", "and see its heartbeat confirm it"},
};
constexpr Example kNmtStopExamples[] = {
    {"nmt stop -n 1", "no PDO and no SDO until `nmt start` or `nmt preop`"},
};
constexpr Example kNmtPreopExamples[] = {
    {"nmt preop -n 1 --wait", "before PDOs are mapped; its heartbeat confirms it"},
    {"nmt preop -n all", "every node, by one message"},
};
constexpr Example kNmtResetExamples[] = {
    {"nmt reset -n 1 --wait", "as after power-on, done when it boots up again"},
};
constexpr Example kNmtResetCommExamples[] = {
    {"nmt reset-comm -n 1 --wait", "1000h to 1FFFh as stored: PDOs, COB-IDs, heartbeat"},
};

template <NmtCommand nmt>
constexpr Command nmt_command(std::string_view path, std::string_view summary, std::string_view details,
                              std::span<const Example> examples) {
  return {.path = path,
          .summary = summary,
          .details = details,
          .parameters = kNmtParameters,
          .examples = examples,
          .needs = Needs::node | Needs::nmt,
          .effect = nmt == NmtCommand::reset_node || nmt == NmtCommand::reset_communication ? Effect::resets
                                                                                            : Effect::writes,
          .family = FamilyCheck::never,
          .run = run_nmt_command<nmt>,
          .to_all = true,
          .way_out = nmt == NmtCommand::stop || nmt == NmtCommand::enter_pre_operational,
          .elsewhere = kNmtElsewhere};
}

/// In a batch file that is read as settings it prepares, and writes no value.
constexpr Command preparing(Command command) {
  command.settings = [](const Arguments&) { return Result<std::vector<settings::NamedValue>>{}; };
  return command;
}

}  // namespace

extern const Command kNmtStart;
constexpr Command kNmtStart = nmt_command<NmtCommand::start>(
    "nmt start", "Set nodes to operational: PDOs active", kStartDetails, kNmtStartExamples);

extern const Command kNmtStop;
constexpr Command kNmtStop = nmt_command<NmtCommand::stop>("nmt stop", "Set nodes to stopped: no PDO, no SDO",
                                                           kDetails, kNmtStopExamples);

extern const Command kNmtPreop;
constexpr Command kNmtPreop = preparing(nmt_command<NmtCommand::enter_pre_operational>(
    "nmt preop", "Set nodes to pre-operational: SDO, no PDO", kDetails, kNmtPreopExamples));

extern const Command kNmtReset;
constexpr Command kNmtReset = nmt_command<NmtCommand::reset_node>(
    "nmt reset", "Restart nodes (NMT reset node); asks first", kResetDetails, kNmtResetExamples);

extern const Command kNmtResetComm;
constexpr Command kNmtResetComm = nmt_command<NmtCommand::reset_communication>(
    "nmt reset-comm", "Reset communication of nodes (NMT); asks first", kResetCommDetails,
    kNmtResetCommExamples);

}  // namespace servoctl::commands
