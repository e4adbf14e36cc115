#include "report/axis.hpp"

#include <algorithm>
#include <cmath>

#include "base/decade.hpp"
#include "base/format.hpp"
#include "base/printable.hpp"
#include "base/text.hpp"
#include "report/chinese_marks.hpp"

namespace servoctl::report {
namespace {

constexpr double kLargest = 1e300;
constexpr double kSlack = 1e-6;  ///< Of a step: what binary fractions miss.
constexpr std::size_t kMostMarks = 50;

Extent widened(Extent extent) {
  if (extent.high - extent.low > 1e-12 * std::max(std::abs(extent.low), std::abs(extent.high))) return extent;
  const double margin = extent.low == 0 ? 1 : std::abs(extent.low) / 10;
  return {extent.low - margin, extent.high + margin};
}

/// The smallest round step of which no more than `most` - 1 lie in the extent.
double step_of(const Extent& extent, std::size_t most) {
  const double least = (extent.high - extent.low) / static_cast<double>(std::max<std::size_t>(most, 2) - 1);
  const double power = power_of_ten(decade_of(least));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= least * (1 - 1e-9)) return factor * power;
  return 10 * power;
}

/// Marks from the first full step on.
Ticks marks(const Extent& extent, double step) {
  Ticks out{step, {}};
  const double last = extent.high / step + kSlack;
  for (double n = std::ceil(extent.low / step - kSlack); n <= last && out.at.size() < kMostMarks; ++n)
    out.at.push_back(n * step);
  return out;
}

}  // namespace

bool is_drawable(double number) { return std::isfinite(number) && std::abs(number) < kLargest; }

std::optional<Extent> extent_of(std::span<const double> numbers) {
  std::optional<Extent> out;
  for (const double number : numbers) {
    if (!is_drawable(number)) continue;
    if (!out) out = Extent{number, number};
    out->low = std::min(out->low, number);
    out->high = std::max(out->high, number);
  }
  return out ? std::optional(widened(*out)) : std::nullopt;
}

std::optional<Extent> time_extent(std::span<const Series> series) {
  std::vector<double> ends;
  for (const auto& one : series)
    for (const double time : one.seconds)
      if (is_drawable(time)) ends.push_back(time);
  if (ends.empty()) return std::nullopt;
  const auto [low, high] = std::minmax_element(ends.begin(), ends.end());
  if (*high > *low) return Extent{*low, *high};
  return Extent{*low, *low + 1};
}

std::string Ticks::text(double value) const {
  if (std::abs(value) < step / 2) return "0";
  const int places = decade_of(step * (1 + 1e-9));
  if (places < -6 || std::abs(value) >= 1e15) return formatted("{:.4g}", value);
  return formatted("{:.{}f}", value, std::max(-places, 0));
}

Ticks ticks_of(const Extent& extent, std::size_t most) { return marks(extent, step_of(extent, most)); }

Axis axis_of(const Extent& extent, std::size_t most) {
  const double step = step_of(extent, most);
  const Extent grown{std::floor(extent.low / step + kSlack) * step,
                     std::ceil(extent.high / step - kSlack) * step};
  return {grown, marks(grown, step)};
}

std::string title_of(const Series& series) {
  auto name = printable(series.name);
  std::replace(name.begin(), name.end(), '_', ' ');
  return series.unit.empty() ? name : chinese_marks(formatted("{} ({})", name, printable(series.unit)));
}

}  // namespace servoctl::report
