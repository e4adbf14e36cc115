#include "od/eds_section.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "base/number.hpp"
#include "base/text.hpp"

namespace servoctl::od {
namespace {

struct KnownName {
  std::string_view name;
  SectionKind kind;
};

constexpr std::array kWhole{KnownName{"MandatoryObjects", SectionKind::list},
                            KnownName{"OptionalObjects", SectionKind::list},
                            KnownName{"ManufacturerObjects", SectionKind::list},
                            KnownName{"DeviceInfo", SectionKind::device_info},
                            KnownName{"DeviceComissioning", SectionKind::commissioning},
                            KnownName{"DeviceCommissioning", SectionKind::commissioning},
                            KnownName{"DummyUsage", SectionKind::dummies},
                            KnownName{"FileInfo", SectionKind::other},
                            KnownName{"Comments", SectionKind::other},
                            KnownName{"Tools", SectionKind::other},
                            KnownName{"DynamicChannels", SectionKind::other},
                            KnownName{"StandardDataTypes", SectionKind::other},
                            KnownName{"SupportedModules", SectionKind::other},
                            KnownName{"ConnectedModules", SectionKind::other}};

/// After the index of an object.
constexpr std::array kEndings{KnownName{"name", SectionKind::names}, KnownName{"value", SectionKind::values},
                              KnownName{"denotation", SectionKind::denotations},
                              KnownName{"objectlinks", SectionKind::other},
                              KnownName{"subobjlinks", SectionKind::other}};

/// After `M` and the number of a module; the last two are followed by an index (CiA 306-1, 4.7).
constexpr auto kOfModule = std::to_array<std::string_view>(
    {"moduleinfo", "comments", "fixedobjects", "subextends", "subext", "fixed"});

bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool is_numbered(std::string_view text, std::string_view start) {
  return text.size() > start.size() && starts_with_nocase(text, start) && is_digit(text[start.size()]);
}

std::optional<std::uint16_t> parse_index(std::string_view digits) {
  const auto index = digits.size() > 4 ? std::nullopt : parse_digits(digits, 16);
  return index ? std::optional(static_cast<std::uint16_t>(*index)) : std::nullopt;
}

std::optional<SectionName> parse_object_name(std::string_view name) {
  const auto at = name.find_first_of("sS");
  const auto index = parse_index(name.substr(0, at));
  if (!index) return std::nullopt;
  SectionName out{SectionKind::object, *index, 0, std::nullopt};
  if (at == std::string_view::npos) return out;
  if (!starts_with_nocase(name.substr(at), "sub")) return std::nullopt;
  const auto digits = name.substr(at + 3);
  const auto sub = digits.size() > 3 ? std::nullopt : parse_digits(digits, 16);
  const auto decimal = parse_digits(digits, 10);
  const bool may_be_decimal = decimal && *decimal <= 0xFF;
  if (!sub || (*sub > 0xFF && !may_be_decimal)) return std::nullopt;
  out.kind = SectionKind::sub;
  out.sub = static_cast<std::uint16_t>(*sub);
  if (may_be_decimal) out.decimal_sub = static_cast<std::uint8_t>(*decimal);
  return out;
}

std::optional<SectionName> parse_belonging(std::string_view name) {
  for (const auto& known : kEndings) {
    if (name.size() <= known.name.size()) continue;
    const auto cut = name.size() - known.name.size();
    const auto index = parse_index(name.substr(0, cut));
    if (index && equals_nocase(name.substr(cut), known.name))
      return SectionName{known.kind, *index, 0, std::nullopt};
  }
  return std::nullopt;
}

bool is_of_module(std::string_view name) {
  if (!is_numbered(name, "M")) return false;
  const auto rest = name.substr(std::min(name.find_first_not_of("0123456789", 1), name.size()));
  return std::any_of(kOfModule.begin(), kOfModule.end(),
                     [&](std::string_view start) { return starts_with_nocase(rest, start); });
}

}  // namespace

std::optional<SectionName> parse_section_name(std::string_view name) {
  if (auto object = parse_object_name(name)) return object;
  for (const auto& known : kWhole)
    if (equals_nocase(known.name, name)) return SectionName{known.kind, 0, 0, std::nullopt};
  if (is_of_module(name) || is_numbered(name, "Tool")) return SectionName{};
  return parse_belonging(name);
}

std::optional<std::string> respelt_section_name(std::string_view name) {
  constexpr std::size_t kLongestName = 40;
  if (name.size() > kLongestName) return std::nullopt;
  std::string plain;
  for (const char c : starts_with_nocase(name, "0x") ? name.substr(2) : name)
    if (c != ' ' && c != '_' && c != '-' && c != '.') plain += c;
  if (parse_section_name(plain)) return plain;
  // 1018sbu1: four digits, something like sub, digits.
  if (plain.size() > 7 && edit_distance(std::string_view(plain).substr(4, 3), "sub") == 1) {
    auto mended = plain.substr(0, 4) + "sub" + plain.substr(7);
    if (parse_section_name(mended)) return mended;
  }
  std::vector<std::string> names;
  for (const auto& known : kWhole) names.emplace_back(known.name);
  const auto best = nearest(plain, names, 1);
  return best.empty() || plain.size() < 5 ? std::nullopt : std::optional(best.front());
}

}  // namespace servoctl::od
