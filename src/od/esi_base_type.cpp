#include <algorithm>
#include <array>

#include "base/number.hpp"
#include "base/text.hpp"
#include "od/esi_types.hpp"

namespace servoctl::od {
namespace {

struct BaseRow {
  std::string_view name;
  DataType type;
  std::uint8_t bits;
};

/// ETG.1020, base data types, and the names of CiA 301 for the same.
constexpr std::array kBase{
    BaseRow{"BOOL", DataType::boolean, 1},
    BaseRow{"BIT", DataType::boolean, 1},
    BaseRow{"BOOLEAN", DataType::boolean, 1},
    BaseRow{"SINT", DataType::i8, 8},
    BaseRow{"INT", DataType::i16, 16},
    BaseRow{"INT24", DataType::i24, 24},
    BaseRow{"DINT", DataType::i32, 32},
    BaseRow{"INT40", DataType::i40, 40},
    BaseRow{"INT48", DataType::i48, 48},
    BaseRow{"INT56", DataType::i56, 56},
    BaseRow{"LINT", DataType::i64, 64},
    BaseRow{"USINT", DataType::u8, 8},
    BaseRow{"BYTE", DataType::u8, 8},
    BaseRow{"BITARR8", DataType::u8, 8},
    BaseRow{"UINT", DataType::u16, 16},
    BaseRow{"WORD", DataType::u16, 16},
    BaseRow{"BITARR16", DataType::u16, 16},
    BaseRow{"UINT24", DataType::u24, 24},
    BaseRow{"UDINT", DataType::u32, 32},
    BaseRow{"DWORD", DataType::u32, 32},
    BaseRow{"BITARR32", DataType::u32, 32},
    BaseRow{"UINT40", DataType::u40, 40},
    BaseRow{"UINT48", DataType::u48, 48},
    BaseRow{"UINT56", DataType::u56, 56},
    BaseRow{"ULINT", DataType::u64, 64},
    BaseRow{"LWORD", DataType::u64, 64},
    BaseRow{"REAL", DataType::f32, 32},
    BaseRow{"LREAL", DataType::f64, 64},
    BaseRow{"TIME_OF_DAY", DataType::time, 48},
    BaseRow{"TIME_DIFFERENCE", DataType::time, 48},
    BaseRow{"GUID", DataType::bytes, 128},
    BaseRow{"DOMAIN", DataType::domain, 0},
    BaseRow{"INTEGER8", DataType::i8, 8},
    BaseRow{"INTEGER16", DataType::i16, 16},
    BaseRow{"INTEGER32", DataType::i32, 32},
    BaseRow{"INTEGER64", DataType::i64, 64},
    BaseRow{"UNSIGNED8", DataType::u8, 8},
    BaseRow{"UNSIGNED16", DataType::u16, 16},
    BaseRow{"UNSIGNED32", DataType::u32, 32},
    BaseRow{"UNSIGNED64", DataType::u64, 64},
    BaseRow{"REAL32", DataType::f32, 32},
    BaseRow{"REAL64", DataType::f64, 64},
    BaseRow{"VISIBLE_STRING", DataType::string, 0},
    BaseRow{"STRING", DataType::string, 0},
    BaseRow{"UNICODE_STRING", DataType::string, 0},
    BaseRow{"OCTET_STRING", DataType::bytes, 0},
};

/// So many bits of a number without sign: `BIT3`.
EsiType bit_field(std::uint64_t bits) {
  EsiType out{bits > 8 ? DataType::u16 : DataType::u8, bits, {}, {}, {}};
  out.high = NodeValue{(std::uint64_t{1} << bits) - 1, false};
  return out;
}

std::optional<EsiType> bit_type(std::string_view name) {
  constexpr std::uint64_t kMostBits = 16;
  if (!starts_with_nocase(name, "BIT")) return std::nullopt;
  const auto bits = parse_digits(name.substr(3), 10);
  if (!bits || *bits == 0 || *bits > kMostBits) return std::nullopt;
  if (*bits == 1) return EsiType{DataType::boolean, 1, {}, {}, {}};
  return bit_field(*bits);
}

/// `STRING(10)`, `OCTET_STRING(8)`.
std::optional<EsiType> sized_type(std::string_view name) {
  const auto open = name.find('(');
  if (open == std::string_view::npos || name.back() != ')') return std::nullopt;
  const auto length = parse_digits(trim(name.substr(open + 1, name.size() - open - 2)), 10);
  const auto base = esi_base_type(trim(name.substr(0, open)));
  if (!length || !base || base->bits != 0) return std::nullopt;
  return EsiType{base->type, *length > 0xFFFF ? 0 : *length * 8, {}, {}, {}};
}

/// `ARRAY [0..7] OF BYTE`: bytes in one entry.
std::optional<EsiType> array_type(std::string_view name) {
  if (!starts_with_nocase(name, "ARRAY")) return std::nullopt;
  const auto open = name.find('[');
  const auto dots = name.find("..");
  const auto close = name.find(']');
  if (open == std::string_view::npos || close == std::string_view::npos || dots == std::string_view::npos ||
      dots < open || close < dots)
    return std::nullopt;
  const auto low = parse_digits(trim(name.substr(open + 1, dots - open - 1)), 10);
  const auto high = parse_digits(trim(name.substr(dots + 2, close - dots - 2)), 10);
  const auto rest = trim(name.substr(close + 1));
  if (!low || !high || *high < *low || *high > 0xFFFF || !starts_with_nocase(rest, "OF")) return std::nullopt;
  const auto base = esi_base_type(trim(rest.substr(2)));
  if (!base || base->bits == 0) return std::nullopt;
  return EsiType{DataType::bytes, (*high - *low + 1) * base->bits, {}, {}, {}};
}

}  // namespace

std::optional<EsiType> esi_base_type(std::string_view name) {
  for (const auto& row : kBase)
    if (equals_nocase(row.name, name)) return EsiType{row.type, row.bits, {}, {}, {}};
  if (name.empty()) return std::nullopt;
  if (auto bits = bit_type(name)) return bits;
  if (auto text = sized_type(name)) return text;
  return array_type(name);
}

std::optional<EsiType> esi_base_type(std::uint16_t number) {
  constexpr std::uint16_t kFirstBits = 0x30;
  constexpr std::uint16_t kLastBits = 0x3F;
  if (number >= kFirstBits && number <= kLastBits)
    return number == kFirstBits ? EsiType{DataType::boolean, 1, {}, {}, {}}
                                : bit_field(number - kFirstBits + 1U);
  switch (number) {
    case 0x1D: return EsiType{DataType::bytes, 128, {}, {}, {}};
    case 0x1E:
    case 0x2D: return EsiType{DataType::u8, 8, {}, {}, {}};
    case 0x1F:
    case 0x2E: return EsiType{DataType::u16, 16, {}, {}, {}};
    case 0x20:
    case 0x2F: return EsiType{DataType::u32, 32, {}, {}, {}};
    case 0x260:
    case 0x261:
    case 0x262:
    case 0x263: return EsiType{DataType::bytes, 0, {}, {}, {}};
    default: return std::nullopt;
  }
}

}  // namespace servoctl::od
