#pragma once

#include <cstdint>
#include <set>
#include <string>

#include "show/desk.hpp"

/// Drives that a command leaves with power.
namespace servoctl::motion {

/// What a user has to know of one.
std::string energised_notice(const session::Session& session, std::uint8_t node);

/// Of one that was left energised: `node 1 was left energised; it is stopped and disabled now`.
Message disabled_notice(std::uint8_t node);

/// Of one whose power could not be taken away: what the user has to do, and why.
Message power_warning(std::uint8_t node, const Message& why);

/// Of one that was enabled, and is in fault where it should be stopped and disabled.
Error ended_in_fault(std::uint8_t node);

/// Looks whether these drives, which were told to be energised through this session, are, and says so of each
/// in the notices; of one that does not tell in the errors. Does not hear Ctrl-C.
void tell_left_energised(show::Desk& desk, const std::set<std::uint8_t>& nodes);

/// Stops and disables them, for a command that ends before its time; the notices say so, and what did not
/// succeed is in `desk.errors`. Does not hear Ctrl-C.
void stop_left_energised(show::Desk& desk);

}  // namespace servoctl::motion
