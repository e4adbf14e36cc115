#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "base/time.hpp"

/// How many counts a turn of a motor has, from what its drive showed while it turned evenly.
namespace servoctl::motion {

/// For those who cannot or do not measure.
inline constexpr std::string_view kOtherWay =
    "--turn gives the 6064h increments per revolution for each motion";

/// A measurement that may be this far off (relative) is of no use, and a number that is farther away from
/// what was measured was not measured.
inline constexpr double kTurnTolerance = 0.01;

/// One look at a motor that turns evenly.
struct TurnLook {
  TimePoint time;
  double position = 0;  ///< 6064h, in increments.
  double speed = 0;     ///< 606Ch, in increments a second.
  double rpm = 0;       ///< By the drive's monitor.
};

/// What the looks tell.
struct TurnMeasurement {
  double increments = 0;   ///< Of 6064h in one turn of the motor.
  double uncertainty = 0;  ///< Relative: one step of the monitor, and two standard errors.
  double by_speed = 0;     ///< The same by 606Ch.
  double rpm = 0;          ///< Mean of the monitor.
  double turns = 0;        ///< That the motor made meanwhile, by the monitor.
  double seconds = 0;
  std::size_t looks = 0;
};

/// The way of 6064h over the integral of the monitor, as a whole and in ten parts, whose spread is half of
/// the uncertainty; `step`: one step of the monitor in rpm. Errc::negative when there are too few looks, the
/// monitor shows nothing or both directions, the parts differ by more than 5 %, 606Ch says another speed than
/// the way (2 %), or the uncertainty is above kTurnTolerance.
Result<TurnMeasurement> measure_turn(std::span<const TurnLook> looks, double step);

/// What is known beforehand of the number.
struct TurnExpectation {
  std::optional<double> told;  ///< A number that somebody knows: it is held against the measurement.
  bool disputed = false;       ///< The manual prints two scales for the monitor, a factor of ten apart.
  std::uint8_t node = 1;       ///< Whose it is, for hints.
};

/// The number that is meant, and why.
struct TurnCounts {
  double counts = 0;
  std::string reason;
};

/// The number behind a measured one, of those within kTurnTolerance: the one that was told; else a power of
/// two; else a round decimal number (1, 2, 2.5, 3.6, 4, 5 or 8 and zeros), unless the scale of the monitor is
/// disputed: ten times a decimal number is one as well, ten times a power of two is none. Errc::negative when
/// there is none.
Result<TurnCounts> counts_behind(double measured, double uncertainty, const TurnExpectation& expected);

}  // namespace servoctl::motion
