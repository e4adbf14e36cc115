#pragma once

#include <cstdint>
#include <vector>

#include "session/session.hpp"

namespace servoctl::session {

/// The first digital inputs (function 02h) or outputs (01h) of a unit; its network is one with Modbus. Errors
/// as of a transfer.
Result<std::vector<bool>> read_inputs(Session& session, std::uint8_t node, std::uint16_t count);
Result<std::vector<bool>> read_outputs(Session& session, std::uint8_t node, std::uint16_t count);

}  // namespace servoctl::session
