#pragma once

#include <string>
#include <vector>

#include "base/result.hpp"
#include "command/command.hpp"

namespace servoctl::cli {

/// A command line taken apart.
struct ParsedLine {
  const command::Command* command = nullptr;
  command::Arguments arguments;  ///< Of the command and of the global options.
};

/// Words without a command: Errc::usage for an option that no command has, or only some.
Result<void> check_options_alone(const std::vector<std::string>& words);

/// Finds the command (global options may stand before it) and its arguments. Errc::usage with the nearest
/// names for an unknown command or option, and for a missing or superfluous word.
Result<ParsedLine> parse_line(const std::vector<std::string>& words);

/// Whether the line asks for help: `--help` or `-h` among its options.
bool asks_for_help(const std::vector<std::string>& words);

/// The command the words name, global options left out: the longest path that fits. `used` counts the words
/// it takes, `first` is the position of its first word. Null when there is none.
struct CommandMatch {
  const command::Command* command = nullptr;
  std::size_t first = 0;
  std::size_t used = 0;
};
CommandMatch match_command(const std::vector<std::string>& words);

}  // namespace servoctl::cli
