#include "show/printed_number.hpp"

#include <algorithm>
#include <string>

#include "base/number.hpp"
#include "base/text.hpp"

namespace servoctl::show {
namespace {

constexpr std::string_view kDecimal = "0123456789";
constexpr std::string_view kHex = "0123456789abcdef";

bool is_of(std::string_view text, std::string_view signs) {
  return !text.empty() && text.find_first_not_of(signs) == std::string_view::npos;
}

/// A number taken apart: `0x001b` is the digits `1b`, marked.
struct Printed {
  bool negative = false;
  bool marked = false;
  std::string_view digits;  ///< Without zeros before them; not empty.

  bool is_decimal() const { return !marked && is_of(digits, kDecimal); }
  std::optional<std::uint64_t> value() const { return parse_digits(digits, is_decimal() ? 10 : 16); }
};

std::optional<Printed> printed(std::string_view text) {
  Printed out;
  if (text.starts_with('-') || text.starts_with('+')) {
    out.negative = text.front() == '-';
    text.remove_prefix(1);
  }
  if (text.starts_with("0x")) {
    out.marked = true;
    text.remove_prefix(2);
  } else if (text.ends_with('h')) {
    out.marked = true;
    text.remove_suffix(1);
  }
  if (!is_of(text, kHex)) return std::nullopt;
  text.remove_prefix(std::min(text.find_first_not_of('0'), text.size() - 1));
  out.digits = text;
  return out;
}

/// Letters alone are a word, but for beside a number that is marked: `ff` is `ffh`.
bool is_same(const Printed& cell, const Printed& typed) {
  if (cell.negative != typed.negative) return false;
  const bool words = !cell.marked && !typed.marked && !cell.is_decimal() && !typed.is_decimal();
  if (cell.digits == typed.digits && (cell.marked || !typed.marked || !cell.is_decimal())) return !words;
  return typed.marked && cell.is_decimal() && cell.value() && cell.value() == typed.value();
}

/// `4-6`, `40h-43h`, `6-0`: both ends count in the same way.
bool is_within(std::string_view range, const Printed& typed) {
  const auto dash = range.find('-', 1);
  if (dash == std::string_view::npos || typed.negative) return false;
  const auto first = printed(range.substr(0, dash));
  const auto last = printed(range.substr(dash + 1));
  if (!first || !last || first->negative || last->negative || first->marked != last->marked) return false;
  if (!first->marked && (!first->is_decimal() || !last->is_decimal())) return false;
  const auto value = parse_digits(typed.digits, first->marked || typed.marked ? 16 : 10);
  const auto [low, high] = std::minmax({first->value(), last->value()});
  return value && low && *low <= *value && *value <= *high;
}

}  // namespace

bool is_marked_hex(std::string_view text) {
  const auto number = printed(text);
  if (!number || !number->marked) return false;
  return text.starts_with("0x") || number->digits.find_first_of(kDecimal) != std::string_view::npos;
}

bool is_number(std::string_view cell, std::string_view typed) {
  const auto number = printed(typed);
  if (!number) return false;
  std::string parts(cell);
  std::replace(parts.begin(), parts.end(), ',', ' ');
  bool meant = false;
  for (const auto part : split(std::string_view(parts), ' ')) {
    if (part.empty()) continue;
    const auto one = printed(part);
    const bool range = !one && part.find('-', 1) != std::string_view::npos;
    if (!one && !range) return false;  // `25 m`, `0 -> 1`: no list of numbers.
    meant = meant || (one ? is_same(*one, *number) : is_within(part, *number));
  }
  return meant;
}

bool is_hex_number(std::string_view cell, std::string_view typed) {
  const auto own = printed(cell);
  const auto number = printed(typed);
  return own && number && own->marked && is_same(*own, *number);
}

bool is_counted_by(std::string_view name, std::string_view typed) {
  const auto number = printed(typed);
  if (!number || number->negative || !number->is_decimal()) return false;
  const auto at = name.find_first_of(kDecimal);
  if (at == 0 || at == std::string_view::npos || !is_of(name.substr(at), kDecimal)) return false;
  const auto own = printed(name.substr(at));
  if (!own || own->digits != number->digits) return false;
  auto label = name.substr(0, at);
  const bool apart = std::string_view(".-_ ").find(label.back()) != std::string_view::npos;
  if (apart) label.remove_suffix(1);
  const auto is_letter = [](char c) {
    return (c >= 'a' && c <= 'z') || static_cast<unsigned char>(c) >= 0x80 || c == ' ' || c == '_';
  };
  return !label.empty() && std::all_of(label.begin(), label.end(), is_letter) &&
         (apart || !is_of(label, kHex));
}

std::optional<std::uint64_t> code_in(std::string_view text, std::size_t most_digits) {
  auto digits = lower(text);
  if (digits.starts_with("0x"))
    digits.erase(0, 2);
  else if (digits.ends_with("h"))
    digits.pop_back();
  if (digits.size() > most_digits) return std::nullopt;
  return parse_digits(digits, 16);
}

}  // namespace servoctl::show
