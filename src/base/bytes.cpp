#include "base/bytes.hpp"

#include <algorithm>

#include "base/hex.hpp"

namespace servoctl {
namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

}  // namespace

std::uint64_t load_le(ByteSpan bytes) {
  std::uint64_t value = 0;
  const std::size_t count = std::min<std::size_t>(bytes.size(), 8);
  for (std::size_t i = 0; i < count; ++i) value |= static_cast<std::uint64_t>(bytes[i]) << (8 * i);
  return value;
}

void store_le(std::uint64_t value, std::span<std::uint8_t> out) {
  for (auto& byte : out) {
    byte = static_cast<std::uint8_t>(value);
    value >>= 8U;
  }
}

Bytes store_le(std::uint64_t value, std::size_t size) {
  Bytes out(size);
  store_le(value, std::span<std::uint8_t>(out));
  return out;
}

std::string to_hex(ByteSpan bytes, std::string_view separator) {
  std::string out;
  for (const auto byte : bytes) {
    if (!out.empty()) out += separator;
    append_hex(byte, 2, out);
  }
  return out;
}

std::string_view as_text(ByteSpan bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::optional<Bytes> parse_hex_bytes(std::string_view text) {
  Bytes out;
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] == ' ') {
      ++i;
      continue;
    }
    if (i + 1 >= text.size()) return std::nullopt;
    const int high = hex_digit(text[i]);
    const int low = hex_digit(text[i + 1]);
    if (high < 0 || low < 0) return std::nullopt;
    out.push_back(static_cast<std::uint8_t>(high * 16 + low));
    i += 2;
  }
  return out;
}

}  // namespace servoctl
