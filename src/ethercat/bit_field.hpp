#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/bytes.hpp"

namespace servoctl::ethercat {

/// `bits` bits of `image` from bit `at` on into `out`, low bits first; what is left of the last byte is 0.
/// Image and `out` are long enough.
inline void read_bits(ByteSpan image, std::size_t at, std::size_t bits, std::span<std::uint8_t> out) {
  for (auto& byte : out) byte = 0;
  for (std::size_t i = 0; i < bits; ++i) {
    const auto bit = image[(at + i) / 8] >> (at + i) % 8 & 1U;
    out[i / 8] = static_cast<std::uint8_t>(out[i / 8] | bit << i % 8);
  }
}

/// The low `bits` bits of `value` into `image` from bit `at` on; no other bit changes.
inline void write_bits(std::span<std::uint8_t> image, std::size_t at, std::size_t bits, ByteSpan value) {
  for (std::size_t i = 0; i < bits; ++i) {
    const auto mask = static_cast<std::uint8_t>(1U << (at + i) % 8);
    auto& byte = image[(at + i) / 8];
    const bool set = (value[i / 8] >> i % 8 & 1U) != 0;
    byte = static_cast<std::uint8_t>(set ? byte | mask : byte & ~mask);
  }
}

}  // namespace servoctl::ethercat
