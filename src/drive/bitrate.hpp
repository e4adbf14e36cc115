#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "drive/profile.hpp"

namespace servoctl::drive {

/// Reads a bitrate in bit/s as people write it: `500k`, `1M`, `500 kbit/s`, `1 Mbit/s`, `500000`. Errc::usage
/// for anything else.
Result<std::uint32_t> parse_bitrate(std::string_view text);
/// `500 kbit/s`, `1 Mbit/s`.
std::string bitrate_text(std::uint32_t bitrate);

/// The bitrates that drives of a family can be set to, from the labels of its parameter (NmtRules::bitrate);
/// empty where the manual prints no codes.
std::vector<std::uint32_t> bitrates_of(const Profile& profile);
/// What the parameter holds for a bitrate. Errc::usage with those that there are; also where the family has
/// no such parameter, or its codes are not known.
Result<std::int64_t> bitrate_code(const Profile& profile, std::uint32_t bitrate);

/// The other way round; empty for a code that is not known.
std::optional<std::uint32_t> bitrate_of_code(const Profile& profile, std::int64_t code);

}  // namespace servoctl::drive
