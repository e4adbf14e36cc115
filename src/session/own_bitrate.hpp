#pragma once

#include <string_view>

#include "base/result.hpp"

namespace servoctl::session {

/// Whether the bitrate of a bus can be found and set from here: that of an interface of the kernel, and of an
/// adapter behind `slcan:`. Errc::usage for any other, with what to do instead; `command` is what was asked
/// for: `bus detect`, `scan --all-bitrates`.
Result<void> check_own_bitrate(std::string_view url, std::string_view command);

}  // namespace servoctl::session
