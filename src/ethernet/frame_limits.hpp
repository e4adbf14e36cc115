#pragma once

#include <cstddef>

#include "base/bytes.hpp"
#include "base/result.hpp"

namespace servoctl::ethernet {

/// Bytes of a frame from the destination address on, without the checksum.
inline constexpr std::size_t kShortestFrame = 60;
inline constexpr std::size_t kLongestFrame = 1514;

/// Errc::bug for a frame that no wire carries: shorter or longer than these.
Result<void> check_frame(ByteSpan frame);

}  // namespace servoctl::ethernet
