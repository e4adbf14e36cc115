#include "base/printable.hpp"

#include <algorithm>

#include "base/utf8.hpp"

namespace servoctl {
namespace {

void append_hex(std::string& out, std::string_view mark, char32_t value, int digits) {
  static constexpr char kDigits[] = "0123456789ABCDEF";
  out += mark;
  for (int shift = 4 * (digits - 1); shift >= 0; shift -= 4) out += kDigits[value >> shift & 0x0FU];
}

void append_escaped(std::string& out, char32_t c) {
  switch (c) {
    case '\n': out += "\\n"; return;
    case '\r': out += "\\r"; return;
    case '\t': out += "\\t"; return;
    default: break;
  }
  if (c < 0x80)
    append_hex(out, "\\x", c, 2);
  else if (c <= 0xFFFF)
    append_hex(out, "\\u", c, 4);
  else
    append_hex(out, "\\U", c, 8);
}

bool is_plain(char c) { return c >= 0x20 && c < 0x7F; }

/// `kept` are controls that stand as they are.
std::string shown(std::string_view text, std::string_view kept) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    // Most text is ASCII, and samples come by the million.
    const auto* const end = std::find_if_not(text.begin(), text.end(), is_plain);
    out.append(text.begin(), end);
    text.remove_prefix(static_cast<std::size_t>(end - text.begin()));
    if (text.empty()) break;
    const auto c = decode_utf8(text);
    if (!c.value)
      append_hex(out, "\\x", static_cast<unsigned char>(text.front()), 2);
    else if (is_hidden_or_control(*c.value) && kept.find(text.front()) == std::string_view::npos)
      append_escaped(out, *c.value);
    else
      out += text.substr(0, c.size);
    text.remove_prefix(c.size);
  }
  return out;
}

}  // namespace

std::string printable(std::string_view text) { return shown(text, {}); }
std::string printable_lines(std::string_view text) { return shown(text, "\n\t"); }

}  // namespace servoctl
