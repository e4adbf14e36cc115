// Drives that raise an alarm when they are asked for an object that they do not have: found before anything
// else of them is read, whatever family the line names.
#include <algorithm>
#include <span>
#include <vector>

#include "cli/shell.hpp"
#include "drive/access_alarms.hpp"
#include "session/ethercat_network.hpp"
#include "session/identify.hpp"
#include "session/modbus_network.hpp"
#include "session/wary.hpp"

namespace servoctl::cli {
namespace {

using command::Effect;
using command::Needs;

/// How a slave is reached, and which registers a unit has, the data of its family tell.
void learn_family(session::Session& session, std::span<const std::uint8_t> nodes,
                  const drive::Profile& profile) {
  auto* ring = session.ethercat();
  auto* line = session.modbus();
  for (const auto node : nodes) {
    if (ring != nullptr) ring->learn(node, profile.rules.coe);
    session::be_wary_of_family(session, node, profile);
    if (line != nullptr) line->learn(node, profile.rules.modbus);
  }
}

/// Whether the command reads of nodes. Whoever writes asks the drive what it is. A recording (replay:)
/// answers only what was asked when it was made.
bool only_reads(const command::Command& command, const command::Arguments& arguments,
                const session::Session& session) {
  return includes(command.needs, Needs::node) && !command.to_silent && !command.to_all &&
         command.effect_with(arguments) == Effect::reads && !session.url().starts_with("replay:");
}

/// Whether the line names objects by address, and each is one that every drive has.
bool names_common_objects(const command::Command& command, const command::Arguments& arguments) {
  bool any = false;
  for (const auto& parameter : command.parameters) {
    if (parameter.kind != command::Kind::object) continue;
    for (const auto& word : arguments.all(parameter.name)) {
      const auto object = parse_object_address(word);
      if (!object || !drive::stops_a_drive(*object)) return false;
      any = true;
    }
  }
  return any;
}

/// A gateway passes on no boot-up: another drive may be at the node since the last line.
void doubt_unheard(session::Session& session, std::span<const std::uint8_t> nodes) {
  if (session.gateway() == nullptr) return;
  for (const auto node : nodes) session.doubt_numbers(node);
}

}  // namespace

/// Before anything else is read: finds the drives that must not be asked for what they do not have.
void Shell::be_wary(Run& run, const command::Arguments& arguments) {
  auto& session = *run.context.session;
  const auto* profile = run.context.profile;
  auto nodes = run.context.nodes;
  doubt_unheard(session, nodes);
  const bool any = profile == nullptr || profile->is_generic() || profile->of_file;
  // Another drive may be there than the one that the user named; and what every drive has needs no question.
  const bool asks_first = any && !names_common_objects(*run.command, arguments);
  session.options().checks_numbers =
      !asks_first && !run.command->way_out && only_reads(*run.command, arguments, session);
  const bool is_decided = profile != nullptr && drive::has_access_alarms(profile->rules);
  // Another drive may be there since its boot-up, and what an earlier line named may be wrong.
  // A stop goes out before anything is read.
  if (is_decided || run.command->way_out)
    nodes.clear();
  else if (!asks_first || !only_reads(*run.command, arguments, session))
    std::erase_if(nodes, [&](std::uint8_t node) { return session.wary_of(node) == nullptr; });
  if (session.modbus() == nullptr) session::consider_numbers(session, nodes);
  if (profile != nullptr) learn_family(session, run.context.nodes, *profile);
}

/// What was noticed while a line read with the family that the user named: it is another.
void Shell::tell_contradicted(Run& run) {
  auto* session = run.context.session;
  const auto* profile = run.context.profile;
  if (session == nullptr || profile == nullptr || !session->options().checks_numbers) return;
  std::vector<std::uint8_t> nodes = run.context.nodes;
  std::erase_if(nodes, [&](std::uint8_t node) { return session->wary_of(node) == nullptr; });
  if (nodes.empty()) return;
  (void)session::identify(*session, nodes, profile->rules);
  (void)run.line.hold_family(nodes, profile, FamilyGate::Weight::reads);
}

}  // namespace servoctl::cli
