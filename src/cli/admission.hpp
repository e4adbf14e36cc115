#pragma once

#include "cli/settings.hpp"
#include "command/command.hpp"

/// Whether a command line may be run.
namespace servoctl::cli {

/// Whether the command may run at all: --read-only refuses what changes a drive, and a line is no batch file.
Result<void> check_allowed(const command::Command& command, const command::Arguments& arguments,
                           const Settings& settings);
/// Whether the line names no bus, node or family where the cabinet file says them: of a command for the whole
/// file they would be ignored. Errc::usage.
Result<void> check_whole_file(const command::Command& command, const Settings& settings);
/// What a command's own check finds in the words of a line whose drives are asked for their family before it
/// runs: told before anything is opened. `context` has no family yet.
Result<void> check_words(const command::Command& command, command::Context& context,
                         const command::Arguments& arguments);
/// What is told once of a line: which words were taken for something that they may not have been meant as. A
/// sub-index of digits alone is hexadecimal, as everywhere.
std::vector<std::string> told_of_words(const command::Command& command, const command::Arguments& arguments);
/// Whether the command can be run on this network: one that speaks in frames needs CAN. Errc::usage.
Result<void> check_network(const command::Command& command, session::Session& session);
/// The same, and whether it may give drives power there, if it does so (Errc::refused).
Result<void> admit(const command::Command& command, const command::Arguments& arguments,
                   session::Session& session);
/// Whether it can be run where drives are known by their registers alone (Modbus); any network else takes it.
/// Errc::usage for a command that needs objects of CiA 301 or CiA 402, and for a family (`profile`, may be
/// null) without registers.
Result<void> check_registers(const command::Command& command, session::Session& session,
                             const drive::Profile* profile, bool chinese);
/// The command was given no node.
Error no_node(const command::Command& command);

/// Whether a word stands for objects that only a dictionary knows: a name, or a pattern.
bool names_objects(const command::Command& command, const command::Arguments& arguments);

}  // namespace servoctl::cli
