#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "od/eds_section.hpp"
#include "od/ini.hpp"
#include "od/value.hpp"

namespace servoctl::od {

/// A section of an object or of one of its sub-indexes.
struct ObjectSection {
  SectionName name;
  const IniSection* section = nullptr;
};

/// A type and the limits of its values.
struct LimitType {
  DataType type = DataType::u32;
  std::optional<Value> low;
  std::optional<Value> high;
  std::string note;  ///< What the entry's data sheet calls the type, where that is not `type`.
};

/// By the number that DataType names.
using LimitTypes = std::map<std::uint16_t, LimitType>;

/// The types 00A0h to 00FFh that a file defines as CANFestival does: sub 1 is the number of a plain type, sub
/// 2 and 3 the lowest and the highest value; of a string sub 2 is its length. `sections` are in rising index.
LimitTypes limit_types(std::span<const ObjectSection> sections);

}  // namespace servoctl::od
