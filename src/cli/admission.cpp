#include "cli/admission.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "base/object_address.hpp"
#include "base/text.hpp"
#include "command/registry.hpp"

namespace servoctl::cli {

using command::Effect;
using command::Needs;

Result<void> check_allowed(const command::Command& command, const command::Arguments& arguments,
                           const Settings& settings) {
  if (command.of_front_end)
    return fail(Errc::usage, message("'{}' is not allowed in a batch file", as_it_is(command.path)),
                "`for` repeats lines; a script runs several files");
  // A command that asks for more than reading is refused as a whole, before anything is opened.
  const auto effect = command.effect_with(arguments);
  if (settings.read_only && effect >= Effect::links && !settings.dry_run)
    return fail(Errc::refused,
                message("'{}' changes {}, and --read-only forbids it", as_it_is(command.path),
                        effect == Effect::links ? "an interface" : "a drive"),
                "leave --read-only out to allow it");
  return {};
}

Result<void> check_whole_file(const command::Command& command, const Settings& settings) {
  const bool whole = command.path.starts_with("cabinet ") && !includes(command.needs, Needs::bus);
  const bool bus = settings.bus_from == Source::line;
  if (!whole || (!bus && !settings.nodes_typed() && !settings.drive_typed())) return {};
  return fail(Errc::usage,
              message("{} is for lines that name their own nodes: bus, nodes and families stand in the "
                      "cabinet file",
                      bus                      ? "--bus"
                      : settings.nodes_typed() ? "--node"
                                               : "--drive"),
              "leave it out; axes are chosen by name: `--axis` or the word after the command");
}

Result<void> check_words(const command::Command& command, command::Context& context,
                         const command::Arguments& arguments) {
  const bool early =
      command.family == command::FamilyCheck::always || command.effect == command::Effect::links;
  if (command.check == nullptr || !early) return {};
  return command.check(context, arguments);
}

std::vector<std::string> told_of_words(const command::Command& command, const command::Arguments& arguments) {
  std::vector<std::string> out;
  for (const auto& parameter : command.parameters) {
    using command::Kind;
    if (parameter.kind != Kind::object && parameter.kind != Kind::parameter && parameter.kind != Kind::topic)
      continue;
    for (const auto& word : arguments.all(parameter.name)) {
      const auto name = word.substr(0, word.find_first_of("=/"));
      const auto sub = doubtful_sub(name);
      if (!sub) continue;
      auto told = formatted("{}: the sub-index is read as hexadecimal: {}h, decimal {}", name, *sub,
                            parse_object_address(name)->sub);
      if (std::find(out.begin(), out.end(), told) == out.end()) out.push_back(std::move(told));
    }
  }
  return out;
}

Result<void> check_network(const command::Command& command, session::Session& session) {
  const auto refuse = [&](std::string_view kind) {
    auto hint = command.elsewhere.empty()
                    ? "objects, states and motions work there: `read`, `status`, `backup`, `jog`"
                    : std::string(command.elsewhere);
    if (session.gateway() != nullptr && kind == "CAN")
      hint = "objects and NMT commands work there: `read`, `param set`, `backup`, `nmt start`";
    return fail(
        Errc::usage,
        message("'{0}' needs {1}, {2} is not {1}", as_it_is(command.path), kind, as_it_is(session.url())),
        hint);
  };
  if (includes(command.needs, Needs::can) && session.can() == nullptr) return refuse("CAN");
  const bool knows_nmt = session.can() != nullptr || session.gateway() != nullptr;
  if (includes(command.needs, Needs::nmt) && !knows_nmt) return refuse("CAN");
  if (includes(command.needs, Needs::ethercat) && session.ethercat() == nullptr) return refuse("EtherCAT");
  return {};
}

Result<void> admit(const command::Command& command, const command::Arguments& arguments,
                   session::Session& session) {
  if (const auto possible = check_network(command, session); !possible) return possible;
  const auto why = session.network().why_no_power();
  if (!why.empty() && command.effect_with(arguments) == Effect::moves)
    return fail(Errc::refused,
                message("'{}' is refused over {}: {}", as_it_is(command.path), as_it_is(session.url()), why),
                "run servoctl where the bus is, or use its CAN interface: socketcand://HOST/can0");
  return {};
}

namespace {

std::string works_on_registers() {
  std::string out;
  for (const auto* command : command::registry())
    if (command->on_registers && includes(command->needs, Needs::bus))
      append(out, formatted("`{}`", command->path), ", ");
  return out;
}

}  // namespace

Result<void> check_registers(const command::Command& command, session::Session& session,
                             const drive::Profile* profile, bool chinese) {
  if (session.modbus() == nullptr) return {};
  if (profile != nullptr && !profile->rules.modbus.exists())
    return fail(Errc::usage, message("of {} no Modbus registers are known", as_it_is(profile->family)),
                "use its CAN or EtherCAT port, or describe the registers: docs/drive-data.md, [modbus]");
  if (command.on_registers) return {};
  auto what = message("'{}' does not work over Modbus, which has parameters and readings alone",
                      as_it_is(command.path));
  // What moves a drive names it.
  if (command.effect < Effect::moves || !includes(command.needs, Needs::node))
    return fail(Errc::usage, std::move(what), message("what works there: {}", works_on_registers()));
  const auto* rules = profile == nullptr ? nullptr : &profile->rules.modbus;
  if (rules == nullptr || rules->motion.empty())
    return fail(Errc::usage, std::move(what), "motion needs the drive's CAN or EtherCAT port");
  return fail(Errc::usage, std::move(what),
              "what its manual has instead, by `param set`: " +
                  (chinese && !rules->motion_zh.empty() ? rules->motion_zh : rules->motion));
}

Error no_node(const command::Command& command) {
  return fail(Errc::usage, message("'{}' needs a node", as_it_is(command.path)),
              message("add -n {} (or a list, or all); `scan` shows who is there", node_name(1)))
      .value();
}

bool names_objects(const command::Command& command, const command::Arguments& arguments) {
  const auto is_name = [](const std::string& word) { return !parse_object_address(word); };
  return std::any_of(command.parameters.begin(), command.parameters.end(), [&](const auto& parameter) {
    const auto words = arguments.all(parameter.name);
    return parameter.kind == command::Kind::object && std::any_of(words.begin(), words.end(), is_name);
  });
}

}  // namespace servoctl::cli
