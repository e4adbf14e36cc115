#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "command/command.hpp"

/// All commands there are. commands/registry.cpp, which knows them, defines these.
namespace servoctl::command {

/// All commands in the order of `help`.
std::span<const Command* const> registry();

/// Command::path of registry()[index], without a look at the command.
std::string_view registered_path(std::size_t index);

/// The command of this exact path, or null.
const Command* find_command(std::string_view path);

}  // namespace servoctl::command
