#include "report/plot.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/text.hpp"
#include "report/axis.hpp"

namespace servoctl::report {
namespace {

constexpr std::size_t kLeastWidth = 40;
constexpr int kDotsAcross = 2;  ///< Of one braille character.
constexpr int kDotsDown = 4;

/// Which of `size` dots stands for this part of the way.
int place(double part, int size) {
  return static_cast<int>(std::lround(std::clamp(part, 0.0, 1.0) * (size - 1)));
}

/// Dots in a grid of braille characters (U+2800 to U+28FF).
class Canvas {
 public:
  Canvas(int columns, int rows)
      : columns_(columns), rows_(rows), cells_(static_cast<std::size_t>(columns * rows)) {}

  int width() const { return columns_ * kDotsAcross; }
  /// The dot, counted from above, of a part of the height, counted from below.
  int from_above(double part) const {
    const int height = rows_ * kDotsDown;
    return height - 1 - place(part, height);
  }

  /// From the upper left; every dot on the way is set.
  void line(int x0, int y0, int x1, int y1) {
    const int steps = std::max({std::abs(x1 - x0), std::abs(y1 - y0), 1});
    for (int i = 0; i <= steps; ++i) dot(x0 + (x1 - x0) * i / steps, y0 + (y1 - y0) * i / steps);
  }

  std::string row(int number) const {
    std::string out;
    for (int column = 0; column < columns_; ++column) {
      const auto bits = cells_[static_cast<std::size_t>(number * columns_ + column)];
      out += bits == 0 ? std::string(" ") : character(bits);
    }
    out.erase(out.find_last_not_of(' ') + 1);
    return out;
  }

 private:
  void dot(int x, int y) {
    // Bits of a character: 1 to 3 and 7 down the left side, 4 to 6 and 8 down the right.
    static constexpr std::uint8_t kBits[kDotsDown][kDotsAcross] = {
        {0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};
    auto& cell = cells_[static_cast<std::size_t>(y / kDotsDown * columns_ + x / kDotsAcross)];
    cell = static_cast<std::uint8_t>(cell | kBits[y % kDotsDown][x % kDotsAcross]);
  }

  static std::string character(std::uint8_t bits) {
    return {'\xE2', static_cast<char>(0xA0 | bits >> 6U), static_cast<char>(0x80 | (bits & 0x3FU))};
  }

  int columns_;
  int rows_;
  std::vector<std::uint8_t> cells_;
};

/// One quantity with its axis, before the labels of all are as wide as the widest.
struct Panel {
  const Series* series;
  Axis axis;
};

void draw(Canvas& canvas, const Panel& panel, const Extent& time) {
  const auto& series = *panel.series;
  bool connected = false;
  int x = 0;
  int y = 0;
  for (std::size_t i = 0; i < std::min(series.seconds.size(), series.values.size()); ++i) {
    const bool there = is_drawable(series.seconds[i]) && is_drawable(series.values[i]);
    if (there) {
      const int next_x = place(time.part(series.seconds[i]), canvas.width());
      const int next_y = canvas.from_above(panel.axis.extent.part(series.values[i]));
      canvas.line(connected ? x : next_x, connected ? y : next_y, next_x, next_y);
      x = next_x;
      y = next_y;
    }
    connected = there;
  }
}

/// The marks below the last quantity.
std::string time_axis(const Extent& time, std::size_t left, std::size_t columns) {
  std::string rule = std::string(left, ' ') + " └";
  std::string labels(left + 2 + columns, ' ');
  const auto ticks = ticks_of(time, columns / 10);
  std::vector<bool> marked(columns);
  for (const double at : ticks.at) {
    const int dot = place(time.part(at), static_cast<int>(columns) * kDotsAcross);
    const auto column = static_cast<std::size_t>(dot / kDotsAcross);
    marked[column] = true;
    const auto text = ticks.text(at);
    // Below its mark; the last one ends where the axis does.
    const auto begin = std::min(left + 2 + column - std::min(column + left, text.size() / 2),
                                labels.size() - std::min(labels.size(), text.size()));
    labels.replace(begin, text.size(), text);
  }
  for (const bool mark : marked) rule += mark ? "┴" : "─";
  labels.replace(0, 1, "s");
  labels.erase(labels.find_last_not_of(' ') + 1);
  return rule + "\n" + labels + "\n";
}

std::string panel_text(const Panel& panel, const Extent& time, std::size_t left, std::size_t columns,
                       int rows) {
  Canvas canvas(static_cast<int>(columns), rows);
  draw(canvas, panel, time);
  std::vector<std::string> labels(static_cast<std::size_t>(rows));
  for (const double at : panel.axis.ticks.at)
    labels[static_cast<std::size_t>(canvas.from_above(panel.axis.extent.part(at)) / kDotsDown)] =
        panel.axis.ticks.text(at);
  std::string out;
  for (int row = 0; row < rows; ++row) {
    const auto& label = labels[static_cast<std::size_t>(row)];
    out += pad_left(label, left) + (label.empty() ? " │" : " ┤") + canvas.row(row) + "\n";
  }
  return out;
}

std::size_t label_width(const Panel& panel) {
  std::size_t out = 0;
  for (const double at : panel.axis.ticks.at) out = std::max(out, panel.axis.ticks.text(at).size());
  return out;
}

}  // namespace

std::string braille_plot(std::span<const Series> series, std::size_t width) {
  width = std::max(width, kLeastWidth);
  const auto time = time_extent(series);
  const int rows = series.size() == 1 ? 9 : 5;
  std::vector<Panel> panels;
  std::size_t left = 1;
  for (const auto& one : series) {
    const auto extent = extent_of(one.values);
    if (!extent || !time) {
      panels.push_back({&one, {}});
      continue;
    }
    panels.push_back({&one, axis_of(*extent, static_cast<std::size_t>(rows) / 2 + 1)});
    left = std::max(left, label_width(panels.back()));
  }
  const auto columns = width - left - 2;
  std::string out;
  bool drawn = false;
  for (const auto& panel : panels) {
    const bool empty = panel.axis.ticks.at.empty();
    out += clip(title_of(*panel.series) + (empty ? ": no samples" : ""), width) + "\n";
    if (empty) continue;
    out += panel_text(panel, *time, left, columns, rows);
    drawn = true;
  }
  return drawn ? out + time_axis(*time, left, columns) : out;
}

}  // namespace servoctl::report
