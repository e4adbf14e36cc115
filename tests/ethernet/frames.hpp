#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "base/bytes.hpp"

namespace servoctl::ethernet {

/// A frame of this length that can be told from others.
inline Bytes frame_of(std::uint8_t number, std::size_t size = 60) {
  Bytes out(size);
  for (std::size_t i = 0; i < size; ++i) out[i] = static_cast<std::uint8_t>(number + i * 7);
  return out;
}

inline Bytes copy(ByteSpan frame) { return {frame.begin(), frame.end()}; }

}  // namespace servoctl::ethernet
