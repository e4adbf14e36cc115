#pragma once

#include <optional>

#include "command/command.hpp"

namespace servoctl::command {

inline constexpr Parameter kForOption{
    .name = "--for", .help = "how long (default: until Ctrl-C)", .kind = Kind::duration};

/// The time of an option; empty when it was not given. Errc::usage when it is no time, or zero.
Result<std::optional<Duration>> duration_option(const Arguments& arguments, std::string_view name);

}  // namespace servoctl::command
