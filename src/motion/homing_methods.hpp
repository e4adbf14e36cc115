#pragma once

#include <cstdint>
#include <vector>

#include "drive/profile.hpp"
#include "session/session.hpp"

namespace servoctl::motion {

/// Supported homing methods (60E3h), as the drive lists them; empty where its data have no such object or it
/// tells none. Errors of an answer that was lost.
Result<std::vector<std::int64_t>> supported_homing(session::Session& session, const drive::Profile& profile,
                                                   std::uint8_t node);

/// Errc::refused for a method that such a list does not have; an empty list refuses none.
Result<void> check_homing(const std::vector<std::int64_t>& supported, std::int64_t method, std::uint8_t node);

}  // namespace servoctl::motion
