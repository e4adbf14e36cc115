#include "command/nmt_result.hpp"

#include <algorithm>
#include <optional>
#include <string_view>

#include "base/format.hpp"
#include "session/can_network.hpp"

namespace servoctl::command {

using canopen::NmtCommand;
using report::Value;
using session::NodeLife;

namespace {

/// What is known of the command and this node; `confirmed`: empty where nobody waited for it.
std::string_view result_of_nmt(const NodeLife& entry, const std::optional<bool>& confirmed) {
  if (confirmed.value_or(false)) return "confirmed";
  return !confirmed && entry.alive ? "sent; the node is there" : "sent, not confirmed";
}

/// What a user may have set a moment ago, and a drive loses.
constexpr std::string_view kSetAndNotStored =
    "unstored changes of PDOs, COB-IDs, heartbeat (1017h) and heartbeat consumers (1016h, the watchdog)";

std::string whom_nmt(std::span<const std::uint8_t> nodes) {
  if (nodes.front() == 0) return "all nodes";
  return nodes.size() == 1 ? formatted("node {}", nodes.front()) : formatted("{} nodes", nodes.size());
}

}  // namespace

bool is_reset(NmtCommand command) {
  return command == NmtCommand::reset_node || command == NmtCommand::reset_communication;
}

bool is_confirmed(session::Session& session, const NodeLife& before, NmtCommand command) {
  if (before.doubled) return false;
  if (is_reset(command)) return session.can()->watch().boots(before.node) > before.boots;
  return session.can()->watch().heartbeats(before.node) > before.heartbeats &&
         session.can()->watch().state(before.node) == canopen::state_after(command);
}

Error unconfirmed(const NodeLife& before, NmtCommand command, const session::Heartbeats& heartbeats,
                  const canopen::NodeWatch& watch) {
  auto error = drive_error(Errc::timeout, before.node,
                           message("'{}' was sent but not confirmed", as_it_is(canopen::name(command))));
  const auto& silent = heartbeats.silent;
  if (is_reset(command))
    error.hint =
        "no boot-up message: it may have restarted with another node-ID or bitrate; `scan` shows who answers";
  else if (std::find(silent.begin(), silent.end(), before.node) != silent.end())
    error.hint = message("the node sends no heartbeat: `heartbeat set 500ms -n {}` switches it on",
                         node_name(before.node));
  else if (watch.heartbeats(before.node) > before.heartbeats)
    error.hint = "its heartbeats still show another state";
  else
    error.hint = "no heartbeat came; unless it is stopped, `read 0x1017` shows whether it sends any";
  return error;
}

report::Table nmt_table(Context& context, std::span<const NodeLife> before, NmtCommand command, bool waited) {
  report::Table table;
  // Two words for one thing.
  const auto unless = [](bool told) { return told ? report::Show::json : report::Show::everywhere; };
  table.columns = {
      {"node"}, {"command"}, {"confirmed", "", unless(!waited)}, {"state"}, {"result", "", unless(waited)}};
  for (const auto& entry : before) {
    const auto state = waited ? context.session->can()->watch().state(entry.node) : std::nullopt;
    std::optional<bool> known;
    if (waited)
      known = is_confirmed(*context.session, entry, command);
    else if (entry.node != 0 && !entry.alive && context.session->can() != nullptr)
      known = false;
    table.rows.push_back({entry.node == 0 ? Value("all") : Value(entry.node), canopen::name(command),
                          known ? Value(*known) : Value(), state ? Value(canopen::name(*state)) : Value(),
                          result_of_nmt(entry, known)});
  }
  return table;
}

std::string communication_goes() {
  return formatted("by CiA 301, 1000h to 1FFFh go back to their power-on values: {} are lost",
                   kSetAndNotStored);
}

std::string question_nmt(std::span<const std::uint8_t> nodes, NmtCommand command) {
  if (command == NmtCommand::reset_node)
    return formatted("Reset {}? Drives restart; a moving axis is no longer controlled.", whom_nmt(nodes));
  return formatted(
      "Reset the communication of {}? PDOs and heartbeats pause, so a moving axis may lose its control; {}.",
      whom_nmt(nodes), communication_goes());
}

void tell_reset(Context& context, std::span<const NodeLife> before, NmtCommand command, bool waited) {
  if (command != NmtCommand::reset_communication) return;
  bool unseen = false;
  for (const auto& entry : before)
    if (waited && is_confirmed(*context.session, entry, NmtCommand::reset_communication))
      context.notices.push_back(
          message("node {}: by CiA 301 1000h to 1FFFh now have their power-on values: {} are lost",
                  node_name(entry.node), kSetAndNotStored));
    else
      unseen = true;
  if (unseen) context.notices.push_back(communication_goes());
}

}  // namespace servoctl::command
