#pragma once

#include "session/session.hpp"
#include "sim/cell.hpp"

namespace servoctl::session {

/// Lets simulated drives live on the bus of the session until it is cancelled. Returns when
/// `Options::cancelled` says so; Errc::bus when the bus is lost.
Result<void> serve(Session& session, sim::Cell& cell);

}  // namespace servoctl::session
