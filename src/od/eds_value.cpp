#include "od/eds_value.hpp"

#include <fmt/format.h>
#include <utility>

#include "base/number.hpp"
#include "base/printable.hpp"
#include "base/text.hpp"

namespace servoctl::od {
namespace {

constexpr std::string_view kNodeId = "$nodeid";

bool has_leading_zero(std::string_view text) {
  const bool hexadecimal = !text.empty() && (text.back() == 'h' || text.back() == 'H');
  return text.size() > 1 && text[0] == '0' && text[1] >= '0' && text[1] <= '9' && !hexadecimal;
}

void warn_of_leading_zero(const IniKey& key, std::string_view number, Findings& findings) {
  if (has_leading_zero(number))
    findings.warn(
        key, "leading-zero",
        fmt::format("'{}' is taken as decimal; by the standard a leading zero means octal", shown(number)),
        "write it without leading zeros, or with 0x");
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
        fmt::format("{}: {} has more digits than {}; taken as {}", key.key, shown(text), name(type), number),
        fmt::format("write {}", number));
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

}  // namespace

std::string shown(std::string_view text) { return clip(printable(text.substr(0, 160)), 40); }

std::string_view without_comment(const IniKey& key, Findings& findings) {
  const auto at = key.value.find_first_of(";#");
  if (at == std::string_view::npos) return key.value;
  findings.warn(
      key, "trailing-comment",
      fmt::format("{}: a comment begins at the start of a line; the rest of this one is skipped", key.key),
      "move the comment to a line of its own");
  return trim(key.value.substr(0, at));
}

std::optional<std::uint64_t> eds_number(const IniKey& key, std::uint64_t max, Findings& findings) {
  const auto text = without_comment(key, findings);
  const auto number = parse_integer(text);
  if (!number || number->negative || number->magnitude > max) {
    findings.error(key, "bad-number",
                   fmt::format("{}: '{}' is no number of 0 to {}", shown(key.key), shown(text), max),
                   "write a number such as 7 or 0x7");
    return std::nullopt;
  }
  warn_of_leading_zero(key, text, findings);
  return number->magnitude;
}

std::optional<NodeValue> eds_value(const IniKey* key, DataType type, Findings& findings) {
  if (key == nullptr || key->value.empty() || type == DataType::domain) return std::nullopt;
  const bool numeric = is_integer(type) || is_real(type);
  const auto written = numeric ? without_comment(*key, findings) : key->value;
  const auto [text, plus_node_id] = numeric ? without_node_id(written) : std::pair(written, false);
  if (text.empty()) return std::nullopt;
  if (plus_node_id && !is_integer(type)) {
    findings.error(*key, "bad-value", fmt::format("{}: $NODEID in a value of {}", key->key, name(type)),
                   "only integers can contain the node-ID");
    return std::nullopt;
  }
  auto value = value_of(*key, type, text, findings);
  if (!value) {
    findings.error(*key, "bad-value", fmt::format("{}: {}", key->key, clip(value.error().message, 200)),
                   fmt::format("write a value of {}, or leave it empty", name(type)));
    return std::nullopt;
  }
  if (is_integer(type)) warn_of_leading_zero(*key, text, findings);
  return NodeValue{std::move(*value), plus_node_id};
}

}  // namespace servoctl::od
