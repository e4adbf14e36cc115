#pragma once

#include <cstdint>
#include <string>

#include "base/time.hpp"

namespace servoctl::can {

/// What the times of a recording count from.
struct LogClock {
  enum class Kind : std::uint8_t {
    none,   ///< The beginning of the recording, or unknown.
    day,    ///< Midnight of a day that is not known.
    local,  ///< 1970, by a clock of unknown time zone.
    utc,    ///< 1970-01-01 UTC.
  };
  Kind kind = Kind::none;
  Duration zero{};  ///< What is added to a time of a frame.
};

/// `2026-11-21 13:59:38.000000`, with a `Z` behind it if it is UTC, or the time of day alone; `between`
/// stands between date and time.
std::string clock_text(const LogClock& clock, Duration time, char between);

}  // namespace servoctl::can
