#include "od/esi_types.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <utility>

#include "base/number.hpp"
#include "base/text.hpp"
#include "od/eds_value.hpp"
#include "od/esi_value.hpp"

namespace servoctl::od {
namespace {

constexpr std::uint64_t kLastSub = 0xFF;
constexpr int kMostAliases = 8;
constexpr std::size_t kMostLabels = 512;
constexpr std::size_t kMostMembers =
    512;  ///< Beyond what sub-indices there are; those that are double are told.

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

/// The texts of an enumeration, in the languages the file has.
std::vector<EnumLabel> labels_of(XmlElement data_type) {
  std::vector<EnumLabel> out;
  for (const auto& info : data_type.children("EnumInfo")) {
    const auto number = esi_integer(info.child("Enum").text());
    const auto value = number ? number->as_signed() : std::nullopt;
    auto text = esi_text(info, "Text");
    if (!value || text.english.empty()) continue;
    if (out.size() == kMostLabels) break;
    // A language may have an EnumInfo of its own.
    const auto known =
        std::find_if(out.begin(), out.end(), [&](const EnumLabel& label) { return label.value == *value; });
    if (known == out.end())
      out.push_back({*value, std::move(text.english), std::move(text.chinese)});
    else if (known->label_zh.empty())
      known->label_zh = std::move(text.chinese);
  }
  return out;
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

EsiTypes::EsiTypes(XmlElement data_types, EsiFindings& findings) {
  for (const auto& type : data_types.children("DataType")) {
    const auto name = type.child("Name").text();
    if (name.empty())
      findings.warn(type, "missing-name", "the type has no Name; nothing can use it", "add Name");
    else if (!by_name_.emplace(name, type).second && !findings.enough_of("duplicate-type"))
      findings.warn(type, "duplicate-type",
                    fmt::format("{} appears again, first in line {}; the first one is used", shown(name),
                                by_name_.at(name).place().line),
                    "remove one of them");
  }
}

XmlElement EsiTypes::find(std::string_view name) const {
  const auto found = by_name_.find(name);
  return found == by_name_.end() ? XmlElement() : found->second;
}

std::optional<EsiType> EsiTypes::plain(std::string_view name) const { return plain(name, 0); }

std::optional<EsiType> EsiTypes::plain(std::string_view name, int depth) const {
  auto base = esi_base_type(name);
  const auto own = find(name);
  if (!own || depth > kMostAliases) return base;
  const auto base_name = own.child("BaseType").text();
  const bool composite = own.child("SubItem") || (own.child("ArrayInfo") && !base_name.empty());
  if (composite) return base;
  if (!base && !base_name.empty() && base_name != name) base = plain(base_name, depth + 1);
  if (!base) return base;
  auto labels = labels_of(own);
  if (!labels.empty()) base->labels = std::move(labels);
  return base;
}

XmlElement EsiTypes::composite(std::string_view name) const {
  const auto own = find(name);
  return own.child("SubItem") || own.child("ArrayInfo") ? own : XmlElement();
}

bool EsiTypes::is_array(XmlElement composite) { return !composite.child("SubItem"); }

std::optional<EsiTypes::Elements> EsiTypes::elements_of(XmlElement data_type, EsiFindings& findings) const {
  const auto info = data_type.child("ArrayInfo");
  if (!info) return std::nullopt;
  Elements out;
  out.base = std::string(data_type.child("BaseType").text());
  out.first = esi_number(info.child("LBound"), kLastSub, findings, 1);
  out.count = esi_number(info.child("Elements"), 0xFFFF, findings);
  return out;
}

void EsiTypes::add_item(XmlElement item, std::vector<EsiMember>& out, EsiFindings& findings) const {
  const auto type = std::string(item.child("Type").text());
  auto display = esi_text(item, "DisplayName");
  auto name = esi_text(item, "Name");
  EsiMember member;
  member.name = display.english.empty() ? std::move(name.english) : std::move(display.english);
  member.name_zh = display.chinese.empty() ? std::move(name.chinese) : std::move(display.chinese);
  member.type = type;
  member.element = item;
  const auto index = item.child("SubIdx");
  const std::uint64_t next = out.empty() ? 0 : out.back().sub + std::uint64_t{1};
  const auto array = plain(type) ? std::nullopt : elements_of(find(type), findings);
  const auto first = index ? esi_number(index, kLastSub, findings, next) : array ? array->first : next;
  const auto count = array ? array->count : 1;
  if (count == 0 || first + count - 1 > kLastSub) {
    findings.error(item, "sub-index-range",
                   fmt::format("{}: {} entries from sub-index {} on; an object has 0 to 255",
                               shown(member.name), count, first),
                   "correct SubIdx, LBound or Elements");
    return;
  }
  for (std::uint64_t i = 0; i < count; ++i) {
    member.sub = static_cast<std::uint8_t>(first + i);
    member.of_array = array.has_value();
    if (array) member.type = array->base;
    out.push_back(member);
  }
}

std::vector<EsiMember> EsiTypes::members(XmlElement composite, std::size_t most,
                                         EsiFindings& findings) const {
  std::vector<EsiMember> out;
  if (is_array(composite)) {
    const auto elements = elements_of(composite, findings);
    const auto count = elements ? std::min(elements->count, kLastSub + 1) : 0;
    for (std::uint64_t i = 0; i < count && elements->first + i <= kLastSub; ++i) {
      EsiMember member;
      member.sub = static_cast<std::uint8_t>(elements->first + i);
      member.type = elements->base;
      member.element = composite;
      member.of_array = true;
      out.push_back(std::move(member));
    }
  } else {
    for (const auto& item : composite.children("SubItem"))
      if (out.size() <= kMostMembers) add_item(item, out, findings);
  }
  if (out.size() > std::min(most, kMostMembers)) {
    findings.error(composite, "too-many-entries", "more entries than any device has; the rest is left out",
                   "the number of Elements is too high");
    out.resize(std::min(most, kMostMembers));
  }
  return out;
}

}  // namespace servoctl::od
