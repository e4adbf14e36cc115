#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "command/command.hpp"

namespace servoctl::command {

/// Help of one command, of a group (`param`), of a word of the prompt (`undo`), of an option (`--for`), or of
/// the program when `path` is empty, in at most `width` columns (0: 100). Errc::usage for an unknown name.
Result<std::string> help_text(std::string_view path, std::size_t width, bool chinese = false);

/// Whether the command reads this option itself although every command has one of the name.
bool has_own(const Command& command, const Parameter& global);

/// `OBJECT`: what stands for the value of an option or for a positional word.
std::string value_word(const Parameter& parameter);

/// `param set ASSIGNMENT… [options]`: how the command is written.
std::string usage_line(std::string_view path);

}  // namespace servoctl::command
