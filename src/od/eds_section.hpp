#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace servoctl::od {

enum class SectionKind : std::uint8_t {
  object,         ///< `[1018]`
  sub,            ///< `[1018sub1]`
  names,          ///< `[1018Name]`, of the entries of a CompactSubObj; the two that follow likewise.
  values,         ///< `[1018Value]`
  denotations,    ///< `[1018Denotation]`
  list,           ///< `[MandatoryObjects]`, `[OptionalObjects]`, `[ManufacturerObjects]`
  device_info,    ///< `[DeviceInfo]`
  commissioning,  ///< `[DeviceComissioning]`, with one m in the standard
  dummies,        ///< `[DummyUsage]`
  other           ///< Known, and nothing in it is needed: comments, links, modules.
};

/// What a section's name says (CiA 306-1, 4.5 and 4.6). Names are compared without case.
struct SectionName {
  SectionKind kind = SectionKind::other;
  std::uint16_t index = 0;                  ///< Of object, sub, names, values and denotations.
  std::uint16_t sub = 0;                    ///< Of sub; hexadecimal, and above 0xFF only by mistake.
  std::optional<std::uint8_t> decimal_sub;  ///< The same digits, should they be meant decimal.
};

/// Empty for a name the standard does not have.
std::optional<SectionName> parse_section_name(std::string_view name);

/// How a misspelt name should read: `0x1018_sub1` → `1018sub1`, `ManufactuerObjects` → `ManufacturerObjects`.
/// Empty when nothing is near.
std::optional<std::string> respelt_section_name(std::string_view name);

}  // namespace servoctl::od
