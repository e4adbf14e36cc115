#include "od/eds_value.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/printable.hpp"
#include "base/text.hpp"

namespace servoctl::od {
namespace {

constexpr std::string_view kNodeId = "$nodeid";

/// The digits behind sign and leading zero, where there is one and no other base is said.
std::string_view behind_leading_zero(std::string_view text) {
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) text.remove_prefix(1);
  const bool hexadecimal = !text.empty() && (text.back() == 'h' || text.back() == 'H');
  const bool leads = text.size() > 1 && text[0] == '0' && text[1] >= '0' && text[1] <= '9' && !hexadecimal;
  return leads ? text.substr(1) : std::string_view();
}

/// Tells a leading zero. False when the value is to be written, and octal and decimal are two numbers.
bool take_leading_zero(const IniKey& key, std::string_view number, ValueUse use, Findings& findings) {
  const auto digits = behind_leading_zero(number);
  if (digits.empty()) return true;
  const auto decimal = parse_digits(digits, 10);
  const auto octal = parse_digits(digits, 8);
  if (use == ValueUse::written && octal && octal != decimal) {
    findings.error(
        key, "octal-value",
        formatted(
            "{}: '{}' is {} by the standard (a leading zero means octal), and {} to most who write it; not "
            "taken",
            shown(key.key), shown(number), *octal, decimal.value_or(0)),
        formatted("write 0x{:X} or {}", *octal, decimal.value_or(0)));
    return false;
  }
  const auto by_standard = !octal             ? std::string("no number")
                           : octal == decimal ? std::string("the same")
                                              : formatted("{}", *octal);
  findings.warn(key, "leading-zero",
                formatted("'{}' is taken as decimal, {}; by the standard a leading zero means octal: {}",
                          shown(number), decimal.value_or(0), by_standard),
                "write it without leading zeros, or with 0x");
  return true;
}

/// Whether there is a node with whose number the sum fits its type.
bool fits_a_node(DataType type, const NodeValue& value) {
  const auto* number = std::get_if<std::uint64_t>(&value.value);
  if (number != nullptr && *number == std::numeric_limits<std::uint64_t>::max()) return false;
  return encode(type, value.for_node(1)).has_value();
}

/// Cuts `$NODEID` and its plus off; what remains is the number, `0` when nothing does. A text that goes on at
/// both ends stays whole: it is no value.
std::pair<std::string_view, bool> without_node_id(std::string_view text) {
  if (text.find('$') == std::string_view::npos) return {text, false};
  const auto at = lower(text).find(kNodeId);
  if (at == std::string::npos) return {text, false};
  const auto after = trim(text.substr(at + kNodeId.size()));
  if (at > 0 && !after.empty()) return {text, false};
  auto rest = at == 0 ? after : trim(text.substr(0, at));
  if (!rest.empty() && rest.front() == '+') rest = trim(rest.substr(1));
  if (!rest.empty() && rest.back() == '+') rest = trim(rest.substr(0, rest.size() - 1));
  return {rest.empty() ? std::string_view("0") : rest, true};
}

/// -1 of i8 written as `0xFFFFFFFF`: two's complement of a wider type. Empty when it is not that.
std::optional<Value> wider_complement(const IniKey& key, DataType type, std::string_view text,
                                      Findings& findings) {
  for (const auto wider : {DataType::i16, DataType::i32, DataType::i64}) {
    auto value = parse_value(wider, text);
    if (!value || !encode(type, *value)) continue;
    const auto number = to_string(*value);
    findings.warn(
        key, "wide-value",
        formatted("{}: {} has more digits than {}; taken as {}", key.key, shown(text), name(type), number),
        formatted("write {}", number));
    return std::move(*value);
  }
  return std::nullopt;
}

/// A real as its IEEE 754 bits in hexadecimal, all digits written: `0x3F800000` is 1. Some tools write so.
Result<Value> real_from_bits(DataType type, std::string_view text) {
  const auto size = size_of(type).value_or(0);
  const auto bits = starts_with_nocase(text, "0x") && text.size() == 2 + 2 * size
                        ? parse_digits(text.substr(2), 16)
                        : std::nullopt;
  return bits ? decode(type, store_le(*bits, size)) : parse_value(type, text);
}

/// A time as days and milliseconds, `365 43200000`, or as one number of 48 bits (CiA 301, 7.4.7.7).
std::optional<Value> time_of(std::string_view text) {
  constexpr std::uint64_t kMostMilliseconds = 0xFFFF'FFFF;
  constexpr std::uint64_t kMostDays = 0xFFFF;
  const auto space = text.find(' ');
  const auto first = parse_integer(text.substr(0, space));
  const auto second = space == std::string_view::npos ? Integer{} : parse_integer(trim(text.substr(space)));
  if (!first || !second || first->negative || second->negative) return std::nullopt;
  if (space == std::string_view::npos)
    return first->magnitude >> 48U == 0 ? std::optional(Value(store_le(first->magnitude, 6))) : std::nullopt;
  if (first->magnitude > kMostDays || second->magnitude > kMostMilliseconds) return std::nullopt;
  return Value(store_le(first->magnitude << 32U | second->magnitude, 6));
}

/// parse_value(), and what tools write beyond it.
Result<Value> value_of(const IniKey& key, DataType type, std::string_view text, Findings& findings) {
  if (is_real(type)) return real_from_bits(type, text);
  if (type == DataType::time)
    if (auto time = time_of(text)) return std::move(*time);
  auto value = parse_value(type, text);
  if (!value && is_signed(type))
    if (auto narrow = wider_complement(key, type, text, findings)) return std::move(*narrow);
  return value;
}

void tell_no_value(const IniKey& key, DataType type, std::string_view text, const Error& error, ValueUse use,
                   Findings& findings) {
  const auto why = clip(error.message.text(), 200);
  const bool is_number = parse_integer(text).has_value();
  if (use == ValueUse::limit && (is_number || !is_integer(type)))
    findings.warn(key, "limit-outside-type", formatted("{}: {}; no limit is taken", key.key, why),
                  formatted("write a limit that {} can have, or leave it empty", name(type)));
  else
    findings.error(key, "bad-value", formatted("{}: {}", key.key, why),
                   formatted("write a value of {}, or leave it empty", name(type)));
}

}  // namespace

std::string shown(std::string_view text) { return clip(printable(text.substr(0, 160)), 40); }

std::string_view without_comment(const IniKey& key, Findings& findings) {
  const auto at = key.value.find_first_of(";#");
  if (at == std::string_view::npos) return key.value;
  findings.warn(
      key, "trailing-comment",
      formatted("{}: a comment begins at the start of a line; the rest of this one is skipped", key.key),
      "move the comment to a line of its own");
  return trim(key.value.substr(0, at));
}

std::optional<std::uint64_t> eds_number(const IniKey& key, std::uint64_t max, Findings& findings) {
  const auto text = without_comment(key, findings);
  const auto number = parse_integer(text);
  if (!number || number->negative || number->magnitude > max) {
    findings.error(key, "bad-number",
                   formatted("{}: '{}' is not a number from 0 to {}", shown(key.key), shown(text), max),
                   "write a number such as 7 or 0x7");
    return std::nullopt;
  }
  take_leading_zero(key, text, ValueUse::told, findings);
  return number->magnitude;
}

std::optional<NodeValue> eds_value(const IniKey* key, DataType type, Findings& findings, ValueUse use) {
  if (key == nullptr || key->value.empty() || type == DataType::domain) return std::nullopt;
  const bool numeric = is_integer(type) || is_real(type);
  const auto written = numeric ? without_comment(*key, findings) : key->value;
  const auto [text, plus_node_id] = numeric ? without_node_id(written) : std::pair(written, false);
  if (text.empty()) return std::nullopt;
  if (plus_node_id && !is_integer(type)) {
    findings.error(*key, "bad-value", formatted("{}: $NODEID in a value of {}", key->key, name(type)),
                   "only integers can contain the node-ID");
    return std::nullopt;
  }
  auto value = value_of(*key, type, text, findings);
  if (!value) {
    tell_no_value(*key, type, text, value.error(), use, findings);
    return std::nullopt;
  }
  if (is_integer(type) && !take_leading_zero(*key, text, use, findings)) return std::nullopt;
  NodeValue out{std::move(*value), plus_node_id};
  if (!plus_node_id || fits_a_node(type, out)) return out;
  findings.add(use == ValueUse::written ? Severity::error : Severity::warning, key->line, key->value_column,
               "node-id-sum",
               formatted("{}: {} fits {} for no node; it is not taken", key->key, shown(written), name(type)),
               "lower the number that is added to $NODEID");
  return std::nullopt;
}

std::string eds_text(DataType type, const Value& value) {
  const auto bits = [&] {
    const auto bytes = encode(type, value).value_or(Bytes{});
    return formatted("0x{:0{}X}", load_le(bytes), 2 * bytes.size());
  };
  if (type == DataType::time) return bits();
  if (is_real(type) && !std::isfinite(to_double(value))) return bits();
  return to_string(value);
}

}  // namespace servoctl::od
