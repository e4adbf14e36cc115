#pragma once

#include <optional>
#include <string_view>

namespace servoctl::drive {

/// One `from` in `to` (`conversion("rev/s", "rpm")` is 60); empty when a unit is unknown or they measure
/// different things. Counts (`inc`, `pulse` and their rates) convert to nothing: what one is worth is known
/// to the drive alone.
std::optional<double> conversion(std::string_view from, std::string_view to);

/// A number with its unit, as a user writes it.
struct NumberWithUnit {
  double number = 0;
  std::string_view unit;  ///< Points into the text.
};
/// Splits `60rpm` and `1.5 rev/s`; empty when the text does not begin with a number or nothing follows it.
std::optional<NumberWithUnit> split_unit(std::string_view text);

/// The unit in which people think of what `unit` measures: `deg` for `rad`, `rpm` for `rad/s`; empty when
/// that is the unit itself or nothing better is known.
std::string_view familiar_unit(std::string_view unit);

}  // namespace servoctl::drive
