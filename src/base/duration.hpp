#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "base/time.hpp"

namespace servoctl {

/// Reads `250ms`, `2s`, `1.5s`, `500us`, `1min`. Empty when it is no time, has no unit, is negative, more
/// than a day, or so short that it would be none.
std::optional<Duration> parse_duration(std::string_view text);

/// The same; Errc::usage says what is wrong with it: a number without a unit is asked for one.
Result<Duration> read_duration(std::string_view text);

/// `250 ms`, `2 s`: the largest unit in which it is a whole number.
std::string to_string(Duration duration);

}  // namespace servoctl
