#include "base/number.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "base/decade.hpp"
#include "base/format.hpp"
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

std::optional<std::int64_t> parse_signed(std::string_view text) {
  const auto number = parse_integer(text);
  return number ? number->as_signed() : std::nullopt;
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

namespace {

/// Beyond these no digit stands where people look for it.
constexpr double kGreatest = 1e15;
constexpr double kLeast = 1e-9;

std::string with_decimals(double value, int decimals) {
  auto out = formatted("{:.{}f}", value, std::max(decimals, 0));
  if (out.find('.') != std::string::npos) {
    while (out.back() == '0') out.pop_back();
    if (out.back() == '.') out.pop_back();
  }
  return out == "-0" ? "0" : out;
}

/// Digits before the point; 0 or less: so many zeros follow it.
int magnitude_of(double value) { return decade_of(value) + 1; }

bool has_plain_form(double value) {
  return std::isfinite(value) && std::abs(value) < kGreatest && std::abs(value) >= kLeast;
}

}  // namespace

std::string plain_number(double value, int digits) {
  if (value == 0) return "0";
  if (!has_plain_form(value)) return formatted("{:.{}g}", value, digits);
  return with_decimals(value, digits - magnitude_of(value));
}

std::string number_text(double value) {
  constexpr int kDecimals = 3;
  constexpr int kDigits = 4;
  constexpr int kMostDigits = 7;
  if (value == 0) return "0";
  if (!has_plain_form(value)) return formatted("{:.{}g}", value, kDigits);
  const int magnitude = magnitude_of(value);
  return with_decimals(value,
                       magnitude > 0 ? std::min(kDecimals, kMostDigits - magnitude) : kDigits - magnitude);
}

std::pair<std::string, std::string> told_apart(double a, double b) {
  constexpr int kMostDigits = 17;
  std::pair out{number_text(a), number_text(b)};
  for (int digits = 5; a != b && out.first == out.second && digits <= kMostDigits; ++digits)
    out = {plain_number(a, digits), plain_number(b, digits)};
  return out;
}

}  // namespace servoctl
