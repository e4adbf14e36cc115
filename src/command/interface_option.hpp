#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "command/command.hpp"

/// What commands about a CAN interface of the kernel have in common.
namespace servoctl::command {

inline constexpr Parameter kInterface{
    .name = "interface", .help = "CAN interface: can0", .kind = Kind::bus, .required = true};

/// The name of the interface in the line: `can0` or `socketcan:can0`. Errc::usage for another bus.
Result<std::string> interface_argument(const Arguments& arguments);

/// A whole number of an option within bounds; empty when it was not given. Errc::usage otherwise.
Result<std::optional<std::uint32_t>> number_option(const Arguments& arguments, std::string_view name,
                                                   std::uint32_t least, std::uint32_t most);

/// Refuses to take an interface down over which this prompt or batch file has left drives energised:
/// Errc::refused.
Result<void> hold_energised(const Context& context, const std::string& name);

/// `2 programs receive from can0 now`, for a question; empty when nobody does.
std::string who_receives(const std::string& name);

}  // namespace servoctl::command
