#include "base/object_address.hpp"

#include "base/hex.hpp"
#include "base/number.hpp"
#include "base/text.hpp"

namespace servoctl {
namespace {

/// Hexadecimal digits with an optional `0x` before or `h` behind.
std::optional<std::uint64_t> hex_field(std::string_view text, std::uint64_t max) {
  if (starts_with_nocase(text, "0x"))
    text.remove_prefix(2);
  else if (!text.empty() && (text.back() == 'h' || text.back() == 'H'))
    text.remove_suffix(1);
  const auto value = parse_digits(text, 16);
  if (!value || *value > max) return std::nullopt;
  return value;
}

}  // namespace

std::string to_string(ObjectAddress address) {
  std::string out = "0x";
  append_hex(address.index, 4, out);
  out += ':';
  append_hex(address.sub, address.sub > 0xF ? 2 : 1, out);
  return out;
}

std::optional<ObjectAddress> parse_object_address(std::string_view text) {
  std::string_view sub_text = "0";
  std::string_view index_text = text;
  const std::string folded = lower(text);
  if (const auto at = folded.find("sub"); at != std::string::npos) {
    index_text = text.substr(0, at);
    sub_text = text.substr(at + 3);
  } else if (const auto colon = text.find_first_of(":."); colon != std::string_view::npos) {
    index_text = text.substr(0, colon);
    sub_text = text.substr(colon + 1);
  }
  const auto index = hex_field(index_text, 0xFFFF);
  const auto sub = hex_field(sub_text, 0xFF);
  if (!index || !sub) return std::nullopt;
  // "100" may be a count, a name or a parameter; an index has four digits or says that it is hexadecimal.
  if (index_text.size() != 4 && !starts_with_nocase(index_text, "0x") && lower(index_text).back() != 'h')
    return std::nullopt;
  return ObjectAddress{static_cast<std::uint16_t>(*index), static_cast<std::uint8_t>(*sub)};
}

}  // namespace servoctl
