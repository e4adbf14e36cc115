#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/time.hpp"

namespace servoctl {

/// Reads `250ms`, `2s`, `1.5s`, `500us`, `1min`; a plain number is milliseconds. Empty when it is no time,
/// negative, or more than a day.
std::optional<Duration> parse_duration(std::string_view text);

/// `250 ms`, `2 s`: the largest unit in which it is a whole number.
std::string to_string(Duration duration);

}  // namespace servoctl
