#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "drive/rules.hpp"

namespace servoctl::drive {

/// How a method of 6098h finds home: it seeks a switch, leaves it over one of its edges, and takes that edge,
/// or the next index pulse after it. Directions are ±1.
struct HomingMethod {
  std::int8_t number = 0;
  std::optional<Input> input;  ///< Whose edge it is; empty: none, the index pulse is all it looks for.
  int seek = 0;                ///< Where it goes first while the switch is not pressed.
  int edge = 0;                ///< -1: the left edge of the switch, +1: the right one.
  int approach = 0;            ///< How it passes the edge in the end, and where it looks for the index pulse.
  bool turns = false;          ///< It turns round where it meets a limit switch first.
  bool index = true;           ///< False: home is the edge itself.
};

/// Methods 1 to 14, 17 to 30, 33 and 34 (CiA 402-2, homing methods); empty for all others.
std::optional<HomingMethod> homing_method(std::int64_t number);

/// Whether the method takes the present position as home, or does nothing: 0, 35 and 37 (CiA 402-2, 6098h).
bool stays_put(std::int64_t number);

/// The switches without which this method of a family does not end: the one whose edge it looks for, and the
/// limit switch at which it turns round. Empty for a method that is not known.
std::vector<Input> switches_of(const MotionRules& rules, std::int64_t method);

}  // namespace servoctl::drive
