#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/series.hpp"

/// What plots of every kind need to know of their axes.
namespace servoctl::report {

struct Extent {
  double low = 0;
  double high = 0;  ///< Above `low`.

  /// Where a value lies: 0 at `low`, 1 at `high`.
  double part(double value) const { return (value - low) / (high - low); }
};

/// Whether a plot can show the number: finite, and not so large that differences overflow.
bool is_drawable(double number);

/// The extent of all that can be drawn; one around a constant. Empty when nothing can be drawn.
std::optional<Extent> extent_of(std::span<const double> numbers);

/// The extent of the times of all series together, not widened by more than a constant needs.
std::optional<Extent> time_extent(std::span<const Series> series);

/// Marks of an axis at 1, 2 or 5 times a power of ten.
struct Ticks {
  double step = 1;
  std::vector<double> at;  ///< Rising, all within the extent.

  /// `0.25`: as many decimals as the step needs.
  std::string text(double value) const;
};

/// At least two and at most `most` (2 or more) marks within the extent where round numbers allow it.
Ticks ticks_of(const Extent& extent, std::size_t most);

/// An axis that begins and ends at a mark, with about `most` (2 or more) of them.
struct Axis {
  Extent extent;
  Ticks ticks;
};
Axis axis_of(const Extent& extent, std::size_t most);

/// `following error (deg)`, or the name alone.
std::string title_of(const Series& series);

}  // namespace servoctl::report
