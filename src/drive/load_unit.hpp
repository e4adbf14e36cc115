#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/result.hpp"

namespace servoctl::drive {

/// What a load moves while the motor turns: a unit of the user's own, such as `mm`, beside those of the
/// motor. Speeds are told in `mm/s`, accelerations in `mm/s^2`.
struct LoadUnit {
  std::string unit;  ///< `mm`, `m`, `in`, or any word that is no unit of the motor.
  double per_rev =
      0;  ///< So much of it in one revolution of the motor; negative where it runs the other way.
};

/// Reads `20 mm`: how far the load moves in one turn of the gear's output, which takes `gear` revolutions of
/// the motor. Errc::usage for a number that is 0 or none, a missing unit, and one of the motor (`deg`, `rpm`,
/// `inc`), which would mean two things.
Result<LoadUnit> parse_load_unit(std::string_view text, double gear);

/// The text in revolutions of the motor where it is a number with the load's unit (`20mm` is `10rev`, `5mm/s`
/// is `2.5rev/s`), or one that converts to it (`2cm`); empty where it is not.
std::optional<std::string> in_revolutions(const LoadUnit& load, std::string_view text);
/// The same of what has no direction, such as a limit or a ramp: whichever way the load runs, its sign stays.
std::optional<std::string> size_in_revolutions(const LoadUnit& load, std::string_view text);

/// A number in a unit of the motor's angle, speed or acceleration (`deg`, `rpm`, `rev/s^2`) in the load's.
struct LoadValue {
  double value = 0;
  std::string unit;
};
/// Empty where the unit is none of these.
std::optional<LoadValue> of_load(const LoadUnit& load, double value, std::string_view unit);

}  // namespace servoctl::drive
