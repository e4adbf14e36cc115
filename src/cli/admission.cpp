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

Result<void> check_network(const command::Command& command, session::Session& session) {
  const auto refuse = [&](std::string_view kind) {
    return fail(Errc::usage,
                fmt::format("'{0}' needs {1}, {2} is not {1}", command.path, kind, session.url()),
                command.elsewhere.empty()
                    ? "objects, states and motions work there: `read`, `status`, `backup`, `jog`"
                    : std::string(command.elsewhere));
  };
  if (includes(command.needs, Needs::can) && session.can() == nullptr) return refuse("CAN");
  if (includes(command.needs, Needs::ethercat) && session.ethercat() == nullptr) return refuse("EtherCAT");
  return {};
}

Error no_node(const command::Command& command) {
  return fail(Errc::usage, fmt::format("'{}' needs a node", command.path),
              "add -n 1 (or a list, or all); `scan` shows who is there")
      .value();
}

}  // namespace servoctl::cli
