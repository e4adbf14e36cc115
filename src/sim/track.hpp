#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>

#include "drive/rules.hpp"

namespace servoctl::sim {

using drive::Input;

/// A switch beside the track, pressed from one place to another.
struct Switch {
  double from = 0;
  double to = 0;
  std::optional<bool> stuck;  ///< Says this, wherever the axis stands.
};

/// What stands along the way of a simulated axis. Places are in turns of the motor from where it stood at
/// power-on; the axis starts between the limit switches, left of the home switch.
struct Track {
  static constexpr double kFar = std::numeric_limits<double>::infinity();

  Switch negative_limit{-kFar, -2, {}};
  Switch positive_limit{4, kFar, {}};
  Switch home{1, 1.5, {}};
  bool limits_stop = false;  ///< The limit switches stop every motion; from the factory drives ignore them.
  double index = 0.25;       ///< Where in each turn the index pulse comes.
  bool no_index = false;     ///< It never comes.
  double scatter = 0;        ///< The switches shift by up to so much from one homing to the next.
  double shift = 0;          ///< By how much they are shifted now.
  /// The switches that a parameter of the drive makes it ignore, and those that one could
  /// (drive::Caution::masks). A limit switch that a parameter has not masked stops every motion in its
  /// direction.
  std::array<bool, 3> masked{};
  std::array<bool, 3> maskable{};

  const Switch& at(Input input) const {
    return input == Input::home ? home : input == Input::negative_limit ? negative_limit : positive_limit;
  }
  bool is_pressed(Input input, double place) const {
    const auto& one = at(input);
    return one.stuck.value_or(place >= one.from + shift && place <= one.to + shift);
  }
  /// Whether the drive acts on the switch: it is pressed, and no parameter masks it.
  bool is_seen(Input input, double place) const {
    return !masked[static_cast<std::size_t>(input)] && is_pressed(input, place);
  }
  /// Whether this limit switch stops motions where it is pressed.
  bool stops(Input limit) const {
    const auto which = static_cast<std::size_t>(limit);
    return !masked[which] && (limits_stop || maskable[which]);
  }
  /// The limit switch at the end this direction (±1) leads to.
  static constexpr Input limit(int direction) {
    return direction < 0 ? Input::negative_limit : Input::positive_limit;
  }
};

}  // namespace servoctl::sim
