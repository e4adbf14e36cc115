#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "base/utf8.hpp"

/// How bytes are looked at by those who tell encodings apart.
namespace servoctl::od {

inline unsigned char at(std::string_view bytes, std::size_t i) {
  return static_cast<unsigned char>(bytes[i]);
}

/// The first byte at or after `from` above 0x7F; the length when there is none.
inline std::size_t next_high(std::string_view bytes, std::size_t from) {
  std::uint64_t eight{};
  for (; from + sizeof eight <= bytes.size(); from += sizeof eight) {
    std::memcpy(&eight, bytes.data() + from, sizeof eight);
    if ((eight & 0x8080'8080'8080'8080U) != 0) break;
  }
  while (from < bytes.size() && at(bytes, from) < 0x80) ++from;
  return from;
}

/// Whether the bytes are UTF-8 throughout; quick where they are ASCII.
inline bool is_utf8_text(std::string_view bytes) { return is_utf8(bytes.substr(next_high(bytes, 0))); }

}  // namespace servoctl::od
