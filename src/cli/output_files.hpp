#pragma once

#include <filesystem>
#include <vector>

#include "cli/settings.hpp"
#include "command/command.hpp"
#include "show/desk.hpp"

/// Files that a line writes because its words name them.
namespace servoctl::cli {

/// Whether the word or option names a file that the command writes.
bool is_output(const command::Command& command, const command::Parameter& parameter);

/// The files that the words of the line name for writing. What --dry-run does not write is left out.
std::vector<std::filesystem::path> output_files(const command::Command& command,
                                                const command::Arguments& arguments, bool dry_run);
/// show::may_replace() for all of them.
Result<void> admit_outputs(const command::Command& command, const command::Arguments& arguments,
                           const Settings& settings, const show::Desk& desk);

}  // namespace servoctl::cli
