#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/object_address.hpp"
#include "base/result.hpp"
#include "session/object_scan.hpp"

/// The indexes of a scan.
namespace servoctl::settings {

/// Communication, the maker's objects and the profile; the further axes of it that have one of these
/// statuswords.
std::vector<session::IndexRange> ranges_of_axes(std::span<const ObjectAddress> statuswords);

/// `2000-2FFF,6000-67FF`, also as `0x2000` and `2000h`: 1000h to 9FFFh, none twice, at most 16. Errc::usage.
Result<std::vector<session::IndexRange>> parse_ranges(std::string_view text);
std::string ranges_text(const std::vector<session::IndexRange>& ranges);
/// The indexes that a scan could not read, `2100-210F`; how many, where they are in many places.
std::string unread_text(const session::ScanState& state);

}  // namespace servoctl::settings
