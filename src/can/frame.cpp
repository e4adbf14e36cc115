#include "can/frame.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "base/hex.hpp"
#include "base/number.hpp"

namespace servoctl::can {
namespace {

/// How can-utils marks a report of the controller, as <linux/can.h> does.
constexpr std::uint32_t kErrorFlag = 0x2000'0000;
constexpr std::uint32_t kExtendedMask = 0x1FFF'FFFF;

std::optional<unsigned> digit(char c) {
  if (c >= '0' && c <= '9') return static_cast<unsigned>(c - '0');
  const char letter = static_cast<char>(c | 0x20);
  if (letter >= 'a' && letter <= 'f') return static_cast<unsigned>(letter - 'a' + 10);
  return std::nullopt;
}

/// Two digits a byte and nothing else; without a heap, as millions of frames are read from logs.
bool read_bytes(std::string_view text, Frame& out) {
  if (text.size() % 2 != 0 || text.size() > 2 * out.data.size()) return false;
  for (std::size_t i = 0; i < text.size(); i += 2) {
    const auto high = digit(text[i]);
    const auto low = digit(text[i + 1]);
    if (!high || !low) return false;
    out.data[i / 2] = static_cast<std::uint8_t>(*high << 4U | *low);
  }
  out.size = static_cast<std::uint8_t>(text.size() / 2);
  return true;
}

}  // namespace

Frame make_frame(std::uint32_t id, std::span<const std::uint8_t> data) {
  Frame frame;
  frame.id = id;
  frame.size = static_cast<std::uint8_t>(std::min<std::size_t>(data.size(), frame.data.size()));
  std::copy_n(data.begin(), frame.size, frame.data.begin());
  return frame;
}

void append(const Frame& frame, std::string& out) {
  const auto id = frame.error ? kErrorFlag | frame.id : frame.id;
  append_hex(id, frame.extended || id > 0x7FF ? 8 : 3, out);
  out += '#';
  if (frame.remote) {
    out += 'R';
    if (frame.size != 0) out += fmt::format_int(frame.size).c_str();
    return;
  }
  for (const auto byte : frame.payload()) append_hex(byte, 2, out);
}

std::string to_string(const Frame& frame) {
  std::string out;
  append(frame, out);
  return out;
}

std::optional<Frame> parse_frame(std::string_view text) {
  const auto hash = text.find('#');
  if (hash != 3 && hash != 8) return std::nullopt;
  Frame frame;
  const auto id = parse_digits(text.substr(0, hash), 16);
  if (!id || *id > (hash == 8 ? kErrorFlag | kExtendedMask : 0x7FFU)) return std::nullopt;
  frame.error = (*id & kErrorFlag) != 0;
  frame.extended = hash == 8 && !frame.error;
  frame.id = static_cast<std::uint32_t>(*id) & kExtendedMask;
  const auto rest = text.substr(hash + 1);
  if (!frame.error && !rest.empty() && (rest.front() == 'R' || rest.front() == 'r')) {
    const auto size = rest.size() == 1 ? std::optional<std::uint64_t>(0) : parse_digits(rest.substr(1), 10);
    if (!size || *size > 8 || rest.size() > 2) return std::nullopt;
    frame.remote = true;
    frame.size = static_cast<std::uint8_t>(*size);
    return frame;
  }
  if (!read_bytes(rest, frame)) return std::nullopt;
  return frame;
}

}  // namespace servoctl::can
