#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "base/result.hpp"
#include "od/value.hpp"

namespace servoctl::od {

/// How an integer object carries its number.
enum class Encoding : std::uint8_t {
  plain,  ///< As it is.
  f32,    ///< The bits of an IEEE-754 number of 32 bits.
  f32hi,  ///< The upper 16 bits of one; the lower are zero.
};

std::string_view name(Encoding encoding);  ///< empty, `f32`, `f32hi`
std::optional<Encoding> parse_encoding(std::string_view name);

/// The number that the raw value stands for.
double decode_number(Encoding encoding, const Value& raw);

/// The raw value, of this integer type, that stands for the number; `f32hi` drops the lower bits. Errc::usage
/// when the number is beyond the range of the encoding.
Result<Value> encode_number(Encoding encoding, DataType type, double number);

}  // namespace servoctl::od
