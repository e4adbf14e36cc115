#pragma once

#include <cstddef>
#include <span>

#include "base/bytes.hpp"

namespace servoctl::sim {

/// Copies bits; bit 0 is the lowest of byte 0. Both spans reach as far as is copied.
inline void copy_bits(std::span<std::uint8_t> to, std::size_t to_bit, ByteSpan from, std::size_t from_bit,
                      std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto source = from_bit + i;
    const auto target = to_bit + i;
    const auto bit = static_cast<unsigned>(from[source / 8] >> source % 8) & 1U;
    const auto mask = 1U << target % 8;
    to[target / 8] = static_cast<std::uint8_t>((to[target / 8] & ~mask) | (bit != 0 ? mask : 0U));
  }
}

}  // namespace servoctl::sim
