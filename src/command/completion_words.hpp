#pragma once

#include <span>
#include <string>
#include <string_view>

#include "command/command.hpp"

/// The words of the registry in the forms that completion scripts need.
namespace servoctl::command {

/// The text in single quotes, for any shell.
/// Whether a name may be offered where a command line is completed: it stands for itself there, in a shell
/// and at the prompt. Names come from files.
bool can_be_offered(std::string_view name);

std::string shell_quoted(std::string_view text);

/// Names of the options, with their short names when only those that take a value are asked for.
std::string options_of(std::span<const Parameter> parameters, bool with_value_only);

/// First words of all commands, each once.
std::string first_words();

/// Second words behind `first`; empty when it is a command by itself.
std::string second_words(std::string_view first);

/// All options of all commands that take a value.
std::string all_value_options();

/// What the scripts offer for a parameter: `=word word`, or one of `objects parameters topics families buses
/// files none`.
std::string source_of(const Parameter& parameter);

}  // namespace servoctl::command
