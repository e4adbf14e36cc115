#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace servoctl {

/// Digits of the given base (2..16) and nothing else; empty on overflow of 64 bits, on a foreign character or
/// no digit.
std::optional<std::uint64_t> parse_digits(std::string_view text, unsigned base);

/// An integer as people write it: sign and magnitude kept apart, so that both the whole of u64 and of i64
/// fit.
struct Integer {
  bool negative = false;
  std::uint64_t magnitude = 0;

  bool operator==(const Integer&) const = default;
  /// The value as i64 when it fits.
  std::optional<std::int64_t> as_signed() const;
  /// The value as u64 when it is not negative.
  std::optional<std::uint64_t> as_unsigned() const;
};

/// Reads `100`, `-5`, `+7`, `0x64`, `64h`, `-0x10`, `0b101`. A leading zero does not mean octal: `010` is
/// ten.
std::optional<Integer> parse_integer(std::string_view text);
/// The same where it fits an i64.
std::optional<std::int64_t> parse_signed(std::string_view text);

/// Reads what parse_integer() reads without base prefix, and `1.5`, `1e3`, `-.25`. Always with a point,
/// whatever the locale; `inf` and `nan` are refused.
std::optional<double> parse_real(std::string_view text);

/// A number with at most so many significant digits, but never fewer than its whole part has, and without an
/// exponent: `1310720`, `0.0001`, `9.99985`.
std::string plain_number(double value, int digits);
/// A number for a sentence: the whole part in full and up to three decimals, seven digits in all, or four
/// significant digits of what is smaller than one: `1310720`, `10` for 9.99985, `28.648`.
std::string number_text(double value);
/// The same of two numbers that are set against each other: with as many digits as tell them apart.
std::pair<std::string, std::string> told_apart(double a, double b);

}  // namespace servoctl
