#pragma once

#include <cstdint>
#include <set>

#include "show/desk.hpp"

namespace servoctl::motion {

/// Looks at drives that somebody else energised through this session, and who is gone now: those that have
/// power, or do not tell, are stopped and disabled, all at the same time. What was done is told at once, what
/// did not succeed is in `desk.errors`. Does not hear Ctrl-C.
void stop_abandoned(show::Desk& desk, const std::set<std::uint8_t>& nodes);

}  // namespace servoctl::motion
