#include "base/number.hpp"

#include <charconv>
#include <cmath>
#include <limits>

#include "base/text.hpp"

namespace servoctl {

std::optional<std::uint64_t> parse_digits(std::string_view text, unsigned base) {
  std::uint64_t value = 0;
  const auto* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value, static_cast<int>(base));
  if (text.empty() || error != std::errc{} || stop != end) return std::nullopt;
  return value;
}

std::optional<std::int64_t> Integer::as_signed() const {
  constexpr auto kMax = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  if (!negative)
    return magnitude <= kMax ? std::optional(static_cast<std::int64_t>(magnitude)) : std::nullopt;
  if (magnitude > kMax + 1) return std::nullopt;
  return static_cast<std::int64_t>(~magnitude + 1);
}

std::optional<std::uint64_t> Integer::as_unsigned() const {
  if (negative && magnitude != 0) return std::nullopt;
  return magnitude;
}

std::optional<Integer> parse_integer(std::string_view text) {
  Integer out;
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) {
    out.negative = text.front() == '-';
    text.remove_prefix(1);
  }
  unsigned base = 10;
  if (starts_with_nocase(text, "0x")) {
    base = 16;
    text.remove_prefix(2);
  } else if (!text.empty() && (text.back() == 'h' || text.back() == 'H')) {
    base = 16;
    text.remove_suffix(1);
  } else if (starts_with_nocase(text, "0b")) {
    base = 2;
    text.remove_prefix(2);
  }
  const auto magnitude = parse_digits(text, base);
  if (!magnitude) return std::nullopt;
  out.magnitude = *magnitude;
  return out;
}

std::optional<double> parse_real(std::string_view text) {
  if (!text.empty() && text.front() == '+') {
    text.remove_prefix(1);
    if (!text.empty() && text.front() == '-') return std::nullopt;
  }
  double value = 0;
  const auto* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (text.empty() || error != std::errc{} || stop != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace servoctl
