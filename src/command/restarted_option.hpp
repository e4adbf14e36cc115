#pragma once

#include "command/command.hpp"
#include "show/owed_restart.hpp"

namespace servoctl::command {

/// `--restarted`, of the commands that show which values wait for a restart.
inline constexpr Parameter kRestartedOption{
    .name = "--restarted",
    .help = "the drive was restarted: nothing that was written before waits for a restart any more",
    .kind = Kind::flag};

/// Whether the line says so. Errc::refused with --read-only: it changes what servoctl remembers. A dry run
/// changes nothing.
Result<bool> says_restarted(const Context& context, const Arguments& arguments);

/// Reads which values of a node wait for a restart, and adds a notice where any do. With `restarted` they are
/// forgotten first.
show::OwedRestart note_owed(Context& context, std::uint8_t node, bool restarted);

/// The same, and adds the values to the record of the node in JSON, as `restart_owed`, where any wait.
void add_owed(Context& context, std::uint8_t node, bool restarted, report::Record& out);

}  // namespace servoctl::command
