#pragma once

#include <span>
#include <string>
#include <string_view>

#include "motion/motion.hpp"

/// What can be said of a motion before there is a drive: for lines that are to be run later.
namespace servoctl::motion {

/// A quantity as it was written, and what it is for.
struct WrittenQuantity {
  enum class Least : std::uint8_t { any, not_zero, above_zero };
  std::string_view word;  ///< `speed`, `--limit`
  ObjectAddress object;
  std::string_view text = {};  ///< Empty: it was not given.
  MotionUnits::Kind kind = MotionUnits::Kind::size;
  Least least = Least::above_zero;
  bool is_limit = false;  ///< Compared with, and written to no object: it may lie between two steps.
};

/// Whether these quantities and those of the options can be read by the family's data. What only the drive
/// tells (counts of a turn, rated values) is left to the run, but its units are not. Errc::usage with the
/// word.
Result<void> check_written(const drive::Profile& profile, std::uint8_t node, const MotionOptions& options,
                           std::span<const WrittenQuantity> quantities);

}  // namespace servoctl::motion
