#pragma once

#include <span>
#include <string>
#include <string_view>

#include "base/series.hpp"

namespace servoctl::report {

/// Quantities over time as one SVG drawing, one below the other over the same time: black lines and marked
/// axes on white, as good on paper as on a screen. Stands in a page as well as in a file of its own; without
/// scripts, styles or references. A number that is not finite leaves a gap. Of many samples only what a
/// reader could see is drawn. Empty without series. `no_samples` is said of one that has none.
std::string svg_plot(std::span<const Series> series, std::string_view no_samples = "no samples");

}  // namespace servoctl::report
