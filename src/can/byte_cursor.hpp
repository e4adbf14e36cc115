#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace servoctl::can {

/// Takes numbers off bytes of a file, of either order; what is beyond their end is zero, and ok() false then.
class ByteCursor {
 public:
  explicit ByteCursor(std::string_view bytes, bool big_endian = false) : bytes_(bytes), big_(big_endian) {}

  std::uint64_t number(std::size_t size) {
    if (bytes_.size() < size) {
      ok_ = false;
      bytes_ = {};
      return 0;
    }
    std::uint64_t out = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const auto byte = static_cast<std::uint8_t>(bytes_[big_ ? i : size - 1 - i]);
      out = out << 8U | byte;
    }
    bytes_.remove_prefix(size);
    return out;
  }
  std::uint8_t u8() { return static_cast<std::uint8_t>(number(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
  std::uint64_t u64() { return number(8); }
  void skip(std::size_t size) {
    ok_ = ok_ && size <= bytes_.size();
    bytes_.remove_prefix(ok_ ? size : bytes_.size());
  }
  std::string_view rest() const { return bytes_; }
  bool ok() const { return ok_; }

 private:
  std::string_view bytes_;
  bool big_;
  bool ok_ = true;
};

}  // namespace servoctl::can
