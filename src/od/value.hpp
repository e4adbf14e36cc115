#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include "base/bytes.hpp"
#include "base/result.hpp"
#include "od/data_type.hpp"

namespace servoctl::od {

/// A value of the object dictionary: i64 for signed types, u64 for unsigned ones and bool, double for reals,
/// text for strings, bytes for the rest.
using Value = std::variant<std::int64_t, std::uint64_t, double, std::string, Bytes>;

/// The bytes an SDO carries for this value. Errc::usage when it does not fit the type.
Result<Bytes> encode(DataType type, const Value& value);

/// The value in the bytes an SDO brought. Strings lose trailing NULs. Errc::protocol when the length does not
/// fit the type.
Result<Value> decode(DataType type, ByteSpan bytes);

/// Reads a plain value of the type: `100`, `-5`, `0x64`, `64h`, `true`, `1.5`, `text`, `hex:00 64`. An
/// unsigned type takes no negative number, a signed one takes hexadecimal two's complement of its own width
/// (`0xFFFF` is -1 in i16). Errc::usage tells the type and its range.
Result<Value> parse_value(DataType type, std::string_view text);

/// `-5`, `100`, `1.5`, `text`, `00 64` for bytes.
std::string to_string(const Value& value);

/// A number as double; strings and bytes give 0.
double to_double(const Value& value);

/// Whether a < b, a == b or a > b as exact numbers (-1, 0, 1). Strings and bytes compare equal to everything.
int compare_numbers(const Value& a, const Value& b);

}  // namespace servoctl::od
