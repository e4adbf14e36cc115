#include "od/eds_types.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "base/number.hpp"
#include "od/complex_type.hpp"
#include "od/eds_value.hpp"

namespace servoctl::od {
namespace {

constexpr std::uint16_t kFirst = 0xA0;
constexpr std::uint16_t kLast = 0xFF;
constexpr std::uint16_t kTypeSub = 1;
constexpr std::uint16_t kLowSub = 2;
constexpr std::uint16_t kHighSub = 3;

const IniKey* default_of(std::span<const ObjectSection> sections, std::uint16_t sub) {
  const auto found = std::find_if(sections.begin(), sections.end(), [&](const ObjectSection& place) {
    return place.name.kind == SectionKind::sub && place.name.sub == sub;
  });
  return found == sections.end() ? nullptr : found->section->find("DefaultValue");
}

std::optional<LimitType> limit_type(std::span<const ObjectSection> sections) {
  const auto* type_key = default_of(sections, kTypeSub);
  const auto code = type_key == nullptr ? std::nullopt : parse_integer(type_key->value);
  if (!code || code->negative || is_complex_type(code->magnitude)) return std::nullopt;
  const auto type = data_type_from_cia(code->magnitude);
  if (!type) return std::nullopt;
  LimitType out{*type, {}, {}, {}};
  const auto index = sections.front().name.index;
  out.note = formatted("type {:04X}h of the data sheet: {}", index, name(*type));
  if (!is_integer(*type) && !is_real(*type)) return out;
  Findings ignored;  // The section of the type tells them.
  const auto limit = [&](std::uint16_t sub) {
    const auto value = eds_value(default_of(sections, sub), *type, ignored);
    return value && !value->plus_node_id ? std::optional(value->value) : std::nullopt;
  };
  out.low = limit(kLowSub);
  out.high = limit(kHighSub);
  if (out.low && out.high && compare_numbers(*out.low, *out.high) > 0) out.low = out.high = std::nullopt;
  if (out.low && out.high) out.note += formatted(", {}..{}", to_string(*out.low), to_string(*out.high));
  return out;
}

}  // namespace

LimitTypes limit_types(std::span<const ObjectSection> sections) {
  LimitTypes out;
  for (auto first = sections.begin(); first != sections.end();) {
    const auto index = first->name.index;
    const auto last = std::find_if(first, sections.end(),
                                   [&](const ObjectSection& place) { return place.name.index != index; });
    if (index > kLast) break;
    if (index >= kFirst)
      if (auto type = limit_type(std::span(first, last))) out.emplace(index, std::move(*type));
    first = last;
  }
  return out;
}

}  // namespace servoctl::od
