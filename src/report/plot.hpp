#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "base/series.hpp"

namespace servoctl::report {

/// Columns of a plot where nothing narrower is asked for.
inline constexpr std::size_t kPlotWidth = 80;

/// Quantities over time in braille characters, one below the other over the same time, with marked axes. No
/// line is longer than `width` columns (at least 40). A number that is not finite leaves a gap; a quantity
/// without any says so. No colours: what is printed reads the same in a terminal, a file and an e-mail. Ends
/// with a line break; empty without series.
std::string braille_plot(std::span<const Series> series, std::size_t width = kPlotWidth);

}  // namespace servoctl::report
