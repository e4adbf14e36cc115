#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "drive/naming.hpp"
#include "od/value.hpp"

namespace servoctl::drive {

/// What is needed to turn text into the value of one object and back: from the panel parameter where there is
/// one, else from the dictionary entry. Pointers into the profile the target came from.
struct Meaning {
  od::DataType type = od::DataType::u32;
  bool type_known = false;
  od::Access access = od::Access::rw;
  std::string_view unit;
  double scale = 1;
  std::optional<od::Value> min;
  std::optional<od::Value> max;
  const std::vector<od::EnumLabel>* labels = nullptr;
  od::Effect effect = od::Effect::unstated;
};

Meaning meaning(const Target& target, std::uint8_t node);

/// Reads what a user writes for this object: a plain number is the raw number that the drive and its panel
/// show; a number with a unit (`60rpm`, `250ms`, `12%`) is converted and must come out exact; an enum label
/// stands for its value. Checked against type and limits. Errc::usage tells range and unit.
Result<od::Value> parse_quantity(const Meaning& meaning, std::string_view text);

/// Checks a value against the limits; `what` names the object in the message.
Result<void> check_limits(const Meaning& meaning, const od::Value& value);

/// Raw × scale without the noise of binary fractions: 400 × 0.1 is 40.
double scaled(const Meaning& meaning, const od::Value& value);

/// The label of the value, or null.
const od::EnumLabel* label_of(const Meaning& meaning, const od::Value& value);

/// `1..5000`, `at least 0`, or empty when no limit is known; raw numbers.
std::string range_text(const Meaning& meaning);

}  // namespace servoctl::drive
