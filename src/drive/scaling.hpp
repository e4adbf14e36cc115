#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "base/object_address.hpp"

namespace servoctl::drive {

/// A quotient of numbers and of objects read from the drive: `[units]` in a rules file.
struct Quotient {
  using Factor = std::variant<double, ObjectAddress>;
  std::vector<Factor> multiply;
  std::vector<Factor> divide;
  std::vector<ObjectAddress> power_of_two;  ///< Objects that hold an exponent of two: also factors.
  bool learned =
      false;  ///< One more factor is the number that no object tells and a turn of the motor shows.
  struct When {
    ObjectAddress object;
    std::uint64_t value = 0;
  };
  std::vector<When> when;  ///< All must hold, else the quotient says nothing.
  bool assumed = false;    ///< The manual does not state it.

  /// Every object it is made of, those of its conditions last.
  std::vector<ObjectAddress> objects() const;
};

/// Ways to the same measure; the first whose conditions hold is right.
using Quotients = std::vector<Quotient>;

/// What counts of a drive can be measured against.
enum class Measure : std::uint8_t { increments_per_turn, pulses_per_turn, rated_torque };

/// A unit that only the drive can convert, and the one people read it in.
struct Bridge {
  std::string_view unit;  ///< `deg`, `rpm`, `rpm/s`, `Nm`
  double factor = 1;      ///< One of the object's own unit in `unit`.
};

/// What must be known of the drive to convert this unit of this object; empty when nothing would help. `inc`,
/// `inc/s`, `inc/s2` are position units of the drive and their rates, `pulse` and `pulse/s` counts of its
/// encoder; `%` is of rated torque in the objects CiA 402 defines so (6071h, 6072h, 6074h, 6077h, 60B2h,
/// 60E0h, 60E1h).
std::optional<Measure> needed_measure(std::string_view unit, ObjectAddress object);

/// The bridge, once the drive has told the measure: increments or pulses in one turn of the motor, rated
/// torque in Nm. Empty for a measure of zero.
std::optional<Bridge> bridge(std::string_view unit, ObjectAddress object, double measure);

}  // namespace servoctl::drive
