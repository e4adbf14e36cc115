#pragma once

#include <cstdint>
#include <optional>

#include "motion/watchdog.hpp"
#include "session/session.hpp"

namespace servoctl::motion {

/// How long a claim takes where nobody contests it: a servoctl that is in motion sends a heartbeat in this
/// time.
inline constexpr Duration kClaiming = std::chrono::milliseconds(110);

/// Makes the node-ID of the plan servoctl's own, just before it is armed: masters that chose the same one at
/// the same time must not feed each other's watchdogs. Waits a moment that Options::claim_seed chooses, sends
/// one heartbeat unless somebody else was heard under the number meanwhile, and listens for the rest of
/// kClaiming. A number that is contested is left to the others: `plan` gets the next one that is free, but
/// for one that the user named: Errc::refused then, and where none is left.
Result<void> claim_producer(session::Session& session, std::uint8_t node, std::optional<std::uint8_t> named,
                            WatchdogPlan& plan);

/// Errc::refused when somebody else was heard under the number servoctl sends heartbeats as: what watches
/// servoctl would not notice its end.
Result<void> check_producer(session::Session& session);

}  // namespace servoctl::motion
