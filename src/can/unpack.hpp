#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace servoctl::can {

struct Unpacked {
  std::string bytes;   ///< Up to where it is damaged or cut, or to the limit.
  bool whole = false;  ///< It is neither, and its checksum is right.
};

/// What zlib (RFC 1950) has packed, `most` bytes of it at most.
Unpacked unpack(std::string_view packed, std::size_t most);

}  // namespace servoctl::can
