#pragma once

#include <cstddef>
#include <cstdint>

#include "base/bytes.hpp"

namespace servoctl::ethercat {

/// Numbers at a byte of something longer, little endian as everything of EtherCAT.
inline std::uint16_t word_at(ByteSpan bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8U);
}
inline std::uint32_t dword_at(ByteSpan bytes, std::size_t at) {
  return word_at(bytes, at) | static_cast<std::uint32_t>(word_at(bytes, at + 2)) << 16U;
}

}  // namespace servoctl::ethercat
