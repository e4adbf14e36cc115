#pragma once

#include <cstdint>
#include <string>

namespace servoctl {

/// The last `digits` hexadecimal digits of the number, in upper case; for what is written millions of times.
inline void append_hex(std::uint32_t number, unsigned digits, std::string& out) {
  while (digits-- > 0) out += "0123456789ABCDEF"[number >> 4U * digits & 0xFU];
}

}  // namespace servoctl
