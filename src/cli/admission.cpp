#include "cli/admission.hpp"

#include <fmt/format.h>

namespace servoctl::cli {

using command::Effect;
using command::Needs;

Result<void> check_allowed(const command::Command& command, const command::Arguments& arguments,
                           const Settings& settings) {
  if (command.of_front_end)
    return fail(Errc::usage, fmt::format("'{}' is not allowed in a batch file", command.path),
                "`for` repeats lines; a script runs several files");
  // A command that asks for more than reading is refused as a whole, before anything is opened.
  const auto effect = command.effect_with(arguments);
  if (settings.read_only && effect >= Effect::links && !settings.dry_run)
    return fail(Errc::refused,
                fmt::format("'{}' changes {}, and --read-only forbids it", command.path,
                            effect == Effect::links ? "an interface" : "a drive"),
                "leave --read-only out to allow it");
  return {};
}

Result<void> check_words(const command::Command& command, command::Context& context,
                         const command::Arguments& arguments) {
  if (command.check == nullptr || command.family != command::FamilyCheck::always) return {};
  return command.check(context, arguments);
}

Result<void> check_network(const command::Command& command, session::Session& session) {
  const auto refuse = [&](std::string_view kind) {
    auto hint = command.elsewhere.empty()
                    ? "objects, states and motions work there: `read`, `status`, `backup`, `jog`"
                    : std::string(command.elsewhere);
    if (session.gateway() != nullptr && kind == "CAN")
      hint = "objects and NMT commands work there: `read`, `param set`, `backup`, `nmt start`";
    return fail(Errc::usage,
                fmt::format("'{0}' needs {1}, {2} is not {1}", command.path, kind, session.url()), hint);
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
    return fail(Errc::refused, fmt::format("'{}' is refused over {}: {}", command.path, session.url(), why),
                "run servoctl where the bus is, or use its CAN interface: socketcand://HOST/can0");
  return {};
}

Result<void> check_registers(const command::Command& command, session::Session& session,
                             const drive::Profile* profile, bool chinese) {
  if (session.modbus() == nullptr) return {};
  if (profile != nullptr && !profile->rules.modbus.exists())
    return fail(Errc::usage, fmt::format("of {} no Modbus registers are known", profile->family),
                "use its CAN or EtherCAT port, or describe the registers: docs/drive-data.md, [modbus]");
  if (command.on_registers) return {};
  auto what =
      fmt::format("'{}' does not work over Modbus, which has parameters and readings alone", command.path);
  // What moves a drive names it.
  if (command.effect < Effect::moves || !includes(command.needs, Needs::node))
    return fail(Errc::usage, std::move(what),
                "what works there: read, write, param get, param set, watch, backup, restore, fault show");
  const auto* rules = profile == nullptr ? nullptr : &profile->rules.modbus;
  if (rules == nullptr || rules->motion.empty())
    return fail(Errc::usage, std::move(what), "motion needs the drive's CAN or EtherCAT port");
  return fail(Errc::usage, std::move(what),
              "what its manual has instead, by `param set`: " +
                  (chinese && !rules->motion_zh.empty() ? rules->motion_zh : rules->motion));
}

Error no_node(const command::Command& command) {
  return fail(Errc::usage, fmt::format("'{}' needs a node", command.path),
              "add -n 1 (or a list, or all); `scan` shows who is there")
      .value();
}

}  // namespace servoctl::cli
