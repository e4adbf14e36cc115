#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "base/bytes.hpp"
#include "base/result.hpp"
#include "od/data_type.hpp"

namespace servoctl::gateway {

/// A data type of CiA 309-3 and how its value is written on the line. Beside those of the standard there are
/// the ones that CANopenNode adds: `hex`, and `x8` to `x64`.
struct ValueType {
  enum class Form : std::uint8_t {
    number,      ///< `b i8 … u64 r32 r64`: decimal.
    hex_number,  ///< `x8 x16 x32 x64`: decimal or hexadecimal in, hexadecimal out.
    text,        ///< `vs`: in double quotes.
    base64,      ///< `os us d`
    time,        ///< `t td`: days and milliseconds, two words.
    hex          ///< `hex`, and where no type is named: bytes, `01 AF`.
  };
  Form form = Form::hex;
  od::DataType type = od::DataType::domain;
};

/// The type of that name, in any case; empty when there is none.
std::optional<ValueType> parse_value_type(std::string_view name);

/// The bytes of the value in these words. Errc::usage for one that is none of the type, and for no bytes at
/// all, which no write of CiA 309-3 has.
Result<Bytes> parse_value(ValueType type, std::span<const std::string> words);

/// The value as it stands in an answer. Bytes of another length than the type has are shown as bytes: `01
/// AF`.
std::string value_text(ValueType type, ByteSpan bytes);

}  // namespace servoctl::gateway
