#pragma once

#include <cstdint>
#include <span>

#include "session/bitrate_scan.hpp"
#include "show/desk.hpp"

namespace servoctl::show {

/// `scan --all-bitrates` of the session's bus: asks first, holds that nobody talks there, and tells each
/// bitrate as it is done. Errors as scan_bitrates(); Errc::usage where the bus is no CAN interface of the
/// kernel, Errc::refused where somebody talks.
Result<std::vector<session::Identity>> scan_all_bitrates(Desk& desk, std::span<const std::uint8_t> nodes);

}  // namespace servoctl::show
