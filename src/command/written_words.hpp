#pragma once

#include "command/command.hpp"

namespace servoctl::command {

/// Whether the words that stand for times and numbers (Kind::duration, Kind::number) can be read as such,
/// for a line that is to be run later. Errc::usage with the option. A time of zero is left to commands with a
/// check of their own, of which some know it, and refused for all others.
Result<void> check_written(const Command& command, const Arguments& arguments);

}  // namespace servoctl::command
