#pragma once

#include <cstdint>
#include <span>

#include "session/bitrate_scan.hpp"
#include "show/desk.hpp"

namespace servoctl::show {

/// Errc::usage where the session's bus is no CAN interface of the kernel.
Result<void> check_all_bitrates(const Desk& desk);

/// `scan --all-bitrates` of the session's bus: asks first, holds that nobody talks there, and tells each
/// bitrate as it is done. Errors as scan_bitrates(); Errc::usage where the bus is no CAN interface of the
/// kernel, Errc::refused where somebody talks.
Result<std::vector<session::Identity>> scan_all_bitrates(Desk& desk, std::span<const std::uint8_t> nodes);

}  // namespace servoctl::show
