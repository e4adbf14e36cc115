#include "od/data_type.hpp"

#include <array>
#include <utility>

#include "od/complex_type.hpp"

namespace servoctl::od {
namespace {

struct Row {
  DataType type;
  std::string_view name;
  std::uint16_t code;
  std::uint8_t size;  ///< 0: varies.
};

constexpr std::array kRows{
    Row{DataType::boolean, "bool", 0x01, 1}, Row{DataType::i8, "i8", 0x02, 1},
    Row{DataType::i16, "i16", 0x03, 2},      Row{DataType::i24, "i24", 0x10, 3},
    Row{DataType::i32, "i32", 0x04, 4},      Row{DataType::i40, "i40", 0x12, 5},
    Row{DataType::i48, "i48", 0x13, 6},      Row{DataType::i56, "i56", 0x14, 7},
    Row{DataType::i64, "i64", 0x15, 8},      Row{DataType::u8, "u8", 0x05, 1},
    Row{DataType::u16, "u16", 0x06, 2},      Row{DataType::u24, "u24", 0x16, 3},
    Row{DataType::u32, "u32", 0x07, 4},      Row{DataType::u40, "u40", 0x18, 5},
    Row{DataType::u48, "u48", 0x19, 6},      Row{DataType::u56, "u56", 0x1A, 7},
    Row{DataType::u64, "u64", 0x1B, 8},      Row{DataType::f32, "f32", 0x08, 4},
    Row{DataType::f64, "f64", 0x11, 8},      Row{DataType::string, "string", 0x09, 0},
    Row{DataType::bytes, "bytes", 0x0A, 0},  Row{DataType::domain, "domain", 0x0F, 0},
    Row{DataType::time, "time", 0x0C, 6},
};

/// CiA 309-3, table of data types, where it has other names; TIME_DIFFERENCE is taken as the six bytes of a
/// time.
constexpr std::pair<std::string_view, DataType> kGatewayNames[] = {
    {"b", DataType::boolean}, {"r32", DataType::f32},  {"r64", DataType::f64},
    {"vs", DataType::string}, {"os", DataType::bytes}, {"us", DataType::string},
    {"d", DataType::domain},  {"t", DataType::time},   {"td", DataType::time}};

const Row& row(DataType type) { return kRows[static_cast<std::size_t>(type)]; }

constexpr bool in_enum_order() {
  for (std::size_t i = 0; i < kRows.size(); ++i)
    if (static_cast<std::size_t>(kRows[i].type) != i) return false;
  return true;
}
static_assert(in_enum_order());

}  // namespace

std::string_view name(DataType type) { return row(type).name; }

std::optional<DataType> parse_data_type(std::string_view name) {
  for (const auto& r : kRows)
    if (r.name == name) return r.type;
  for (const auto& [theirs, type] : kGatewayNames)
    if (theirs == name) return type;
  return std::nullopt;
}

std::uint16_t cia_code(DataType type) { return row(type).code; }

std::optional<DataType> data_type_from_cia(std::uint64_t code) {
  if (code == 0x0B) return DataType::string;  // UNICODE_STRING
  if (code == 0x0D) return DataType::time;    // TIME_DIFFERENCE
  for (const auto& r : kRows)
    if (r.code == code) return r.type;
  return is_complex_type(code) ? std::optional(DataType::domain) : std::nullopt;
}

std::optional<std::size_t> size_of(DataType type) {
  const auto size = row(type).size;
  return size == 0 ? std::nullopt : std::optional<std::size_t>(size);
}

bool is_signed(DataType type) { return type >= DataType::i8 && type <= DataType::i64; }
bool is_unsigned(DataType type) {
  return type == DataType::boolean || (type >= DataType::u8 && type <= DataType::u64);
}
bool is_integer(DataType type) { return is_signed(type) || is_unsigned(type); }
bool is_real(DataType type) { return type == DataType::f32 || type == DataType::f64; }

}  // namespace servoctl::od
