#pragma once

#include <cstdint>
#include <span>

#include "session/bitrate_scan.hpp"
#include "session/scan.hpp"
#include "show/desk.hpp"

namespace servoctl::show {

/// `scan --all-bitrates` of the session's bus: asks first, holds that nobody talks there, and tells each
/// bitrate as it is done. Errors as scan_bitrates(), and check_own_bitrate(); Errc::refused where somebody
/// talks, or the bus is in use by this process. The adapter of an `slcan:` bus is left at the bitrate where
/// nodes answered: NamedBitrate puts it back.
Result<std::vector<session::Identity>> scan_all_bitrates(Desk& desk, std::span<const std::uint8_t> nodes,
                                                         const session::BeforeDetails& before_details);

}  // namespace servoctl::show
