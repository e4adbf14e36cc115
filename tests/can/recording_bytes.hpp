#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "can/recording.hpp"

namespace servoctl::can {

/// A file of bytes, put together by hand.
class FileBytes {
 public:
  explicit FileBytes(bool big_endian = false) : big_(big_endian) {}
  FileBytes& text(std::string_view bytes) {
    all_ += bytes;
    return *this;
  }
  FileBytes& bytes(std::initializer_list<int> list) {
    for (const int byte : list) all_ += static_cast<char>(byte);
    return *this;
  }
  FileBytes& zeros(std::size_t count) {
    all_.append(count, '\0');
    return *this;
  }
  FileBytes& number(std::uint64_t value, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i)
      all_ += static_cast<char>(value >> 8 * (big_ ? size - 1 - i : i) & 0xFFU);
    return *this;
  }
  FileBytes& u16(std::uint64_t value) { return number(value, 2); }
  FileBytes& u32(std::uint64_t value) { return number(value, 4); }
  FileBytes& u64(std::uint64_t value) { return number(value, 8); }
  const std::string& str() const { return all_; }

 private:
  std::string all_;
  bool big_;
};

/// What a recording holds: frames in the notation of candump, then what was left out, then where it ends.
inline std::vector<std::string> frames_of(std::string_view content) {
  std::vector<std::string> out;
  const auto strays = for_each_frame(content, [&](const LogFrame& frame) {
    out.push_back(to_string(frame));
    return true;
  });
  if (strays.unknown > 0)
    out.push_back("unknown " + std::to_string(strays.unknown) + " at " + std::to_string(strays.first));
  if (strays.unsuited > 0) out.push_back("unsuited " + std::to_string(strays.unsuited));
  if (strays.damage)
    out.push_back("damage at " + std::to_string(strays.damage->offset) + ": " + strays.damage->what);
  return out;
}

}  // namespace servoctl::can
