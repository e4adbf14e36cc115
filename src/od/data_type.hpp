#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace servoctl::od {

/// Static data types of CiA 301, 7.4.7 (table 44). `bytes` is OCTET_STRING, `string` VISIBLE_STRING (and
/// UNICODE_STRING), `time` TIME_OF_DAY and TIME_DIFFERENCE.
enum class DataType : std::uint8_t {
  boolean,
  i8,
  i16,
  i24,
  i32,
  i40,
  i48,
  i56,
  i64,
  u8,
  u16,
  u24,
  u32,
  u40,
  u48,
  u56,
  u64,
  f32,
  f64,
  string,
  bytes,
  domain,
  time
};

/// The name used in files and JSON: `bool i8 … u64 f32 f64 string bytes domain time`.
std::string_view name(DataType type);
std::optional<DataType> parse_data_type(std::string_view name);

/// The number of the type in an EDS (`DataType=0x0007` is u32), and back. Empty for types CiA 301 does not
/// define.
std::uint16_t cia_code(DataType type);
std::optional<DataType> data_type_from_cia(std::uint64_t code);

/// Size in bytes; empty where it varies (string, bytes, domain).
std::optional<std::size_t> size_of(DataType type);

bool is_signed(DataType type);    ///< i8..i64
bool is_unsigned(DataType type);  ///< bool, u8..u64
bool is_integer(DataType type);   ///< both of the above
bool is_real(DataType type);      ///< f32, f64

}  // namespace servoctl::od
