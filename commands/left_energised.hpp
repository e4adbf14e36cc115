#pragma once

#include <cstdint>
#include <string>

#include "commands/command.hpp"

/// Drives that a command leaves with power.
namespace servoctl::commands {

/// What a user has to know of one.
std::string energised_notice(std::uint8_t node);

/// Looks whether the drives that were energised through this session still are, and says so of each: in the
/// notices, also where one does not tell.
void tell_left_energised(Context& context);

/// Stops and disables them, for a command that ends before its time; the notices say so, and what did not
/// succeed is in `context.errors`. Does not hear Ctrl-C.
void stop_left_energised(Context& context);

}  // namespace servoctl::commands
