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

struct Parts {
  std::string_view index;
  std::string_view sub = "0";
};

Parts parts_of(std::string_view text) {
  if (const auto at = lower(text).find("sub"); at != std::string::npos)
    return {text.substr(0, at), text.substr(at + 3)};
  if (const auto mark = text.find_first_of(":."); mark != std::string_view::npos)
    return {text.substr(0, mark), text.substr(mark + 1)};
  return {text};
}

}  // namespace

std::string to_string(ObjectAddress address) {
  std::string out = "0x";
  append_hex(address.index, 4, out);
  out += ':';
  // From 0Ah on the number says what it is; below, decimal and hexadecimal are one.
  const bool is_one_digit = address.sub < 0xA;
  append_hex(address.sub, is_one_digit ? 1 : 2, out);
  if (!is_one_digit) out += 'h';
  return out;
}

std::optional<ObjectAddress> parse_object_address(std::string_view text) {
  const auto [index_text, sub_text] = parts_of(text);
  const auto index = hex_field(index_text, 0xFFFF);
  const auto sub = hex_field(sub_text, 0xFF);
  if (!index || !sub) return std::nullopt;
  // "100" may be a count, a name or a parameter; an index has four digits or says that it is hexadecimal.
  if (index_text.size() != 4 && !starts_with_nocase(index_text, "0x") && lower(index_text).back() != 'h')
    return std::nullopt;
  return ObjectAddress{static_cast<std::uint16_t>(*index), static_cast<std::uint8_t>(*sub)};
}

std::optional<std::string_view> doubtful_sub(std::string_view text) {
  const auto address = parse_object_address(text);
  const auto sub = parts_of(text).sub;
  if (!address || sub.find_first_not_of("0123456789") != std::string_view::npos || address->sub < 0xA)
    return std::nullopt;
  return sub;
}

}  // namespace servoctl
