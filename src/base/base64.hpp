#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/bytes.hpp"

namespace servoctl {

/// RFC 2045, 6.8, in one line: as CiA 309-3 has octet strings, unicode strings and domains, and data: URIs
/// (RFC 2397) have pictures.
std::string to_base64(ByteSpan bytes);
/// Empty where a foreign character stands, or the end is none. Padding may be left out.
std::optional<Bytes> parse_base64(std::string_view text);

}  // namespace servoctl
