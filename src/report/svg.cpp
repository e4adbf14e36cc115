#include "report/svg.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/format.hpp"
#include "base/text.hpp"
#include "report/axis.hpp"
#include "report/chinese_marks.hpp"
#include "report/markup.hpp"

namespace servoctl::report {
namespace {

// All in the drawing's own units, which are pixels where the page is wide enough.
constexpr double kWidth = 720;
constexpr double kLeft = 72;  ///< Room for the numbers of the value axis.
constexpr double kRight = 12;
constexpr double kTitle = 22;
constexpr double kPanel = 112;
constexpr double kPlotGap = 14;
constexpr double kTimeAxis = 34;
constexpr double kInner = kWidth - kLeft - kRight;
constexpr std::size_t kMostTicks = 5;

struct Point {
  double x;
  double y;
};

/// The points of one unbroken line; of those in the same half pixel only first, lowest, highest and last.
class Thinned {
 public:
  void add(Point point) {
    if (!points_.empty() && std::floor(point.x * 2) == column_) {
      low_ = std::min(low_, point.y);
      high_ = std::max(high_, point.y);
      last_ = point;
      ++count_;
      return;
    }
    finish();
    column_ = std::floor(point.x * 2);
    low_ = high_ = point.y;
    last_ = point;
    count_ = 1;
    points_.push_back(point);
  }

  std::string take() {
    finish();
    // A single sample is a line of no length: its round ends are a dot.
    if (points_.size() == 1) points_.push_back(points_.front());
    std::string out;
    for (const auto& point : points_) append(out, formatted("{:.1f},{:.1f}", point.x, point.y), " ");
    points_.clear();
    return out;
  }

 private:
  void finish() {
    if (points_.empty() || count_ < 2) return;
    if (count_ > 2) {
      points_.push_back({last_.x, low_});
      points_.push_back({last_.x, high_});
    }
    points_.push_back(last_);
    count_ = 0;
  }

  std::vector<Point> points_;
  double column_ = 0;
  double low_ = 0;
  double high_ = 0;
  Point last_{};
  std::size_t count_ = 0;
};

std::string line_of(const Series& series, const Extent& time, const Extent& extent, double top) {
  std::string out;
  Thinned run;
  const auto end_run = [&] {
    const auto points = run.take();
    if (!points.empty()) out += formatted("<polyline points=\"{}\"/>\n", points);
  };
  for (std::size_t i = 0; i < std::min(series.seconds.size(), series.values.size()); ++i) {
    if (!is_drawable(series.seconds[i]) || !is_drawable(series.values[i])) {
      end_run();
      continue;
    }
    run.add(
        {kLeft + kInner * time.part(series.seconds[i]), top + kPanel * (1 - extent.part(series.values[i]))});
  }
  end_run();
  return out;
}

std::string rule(double x1, double y1, double x2, double y2, std::string_view colour) {
  return formatted(R"(<line x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}" stroke="{}"/>)"
                   "\n",
                   x1, y1, x2, y2, colour);
}

std::string label(double x, double y, std::string_view anchor, const std::string& text) {
  return formatted(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="{}">{}</text>)"
                   "\n",
                   x, y, anchor, escaped(text));
}

std::string panel(const Series& series, const Extent& time, double top, std::string_view no_samples) {
  const auto extent = extent_of(series.values);
  if (!extent)
    return label(kLeft, top + 14, "start", chinese_marks(formatted("{}: {}", title_of(series), no_samples)));
  const auto axis = axis_of(*extent, kMostTicks);
  std::string out = label(kLeft, top + 14, "start", title_of(series));
  top += kTitle;
  for (const double at : axis.ticks.at) {
    const double y = top + kPanel * (1 - axis.extent.part(at));
    out += rule(kLeft, y, kLeft + kInner, y, "#d0d0d0");
    out += label(kLeft - 6, y + 4, "end", axis.ticks.text(at));
  }
  for (const double at : ticks_of(time, 2 * kMostTicks).at) {
    const double x = kLeft + kInner * time.part(at);
    out += rule(x, top, x, top + kPanel, "#e8e8e8");
  }
  out += rule(kLeft, top, kLeft, top + kPanel, "#000") +
         rule(kLeft, top + kPanel, kLeft + kInner, top + kPanel, "#000");
  return out +
         "<g fill=\"none\" stroke=\"#000\" stroke-width=\"1.5\" stroke-linecap=\"round\" "
         "stroke-linejoin=\"round\">\n" +
         line_of(series, time, axis.extent, top) + "</g>\n";
}

std::string time_axis(const Extent& time, double top) {
  const auto ticks = ticks_of(time, 2 * kMostTicks);
  std::string out;
  for (const double at : ticks.at) {
    const double x = kLeft + kInner * time.part(at);
    out += rule(x, top, x, top + 4, "#000") + label(x, top + 16, "middle", ticks.text(at));
  }
  return out + label(kLeft - 16, top + 16, "end", "s");
}

double height_of(const Series& series) { return extent_of(series.values) ? kTitle + kPanel : kTitle; }

}  // namespace

std::string svg_plot(std::span<const Series> series, std::string_view no_samples) {
  if (series.empty()) return {};
  const auto time = time_extent(series).value_or(Extent{0, 1});
  std::string names;
  std::string drawing;
  double top = 0;
  for (const auto& one : series) {
    append(names, title_of(one));
    drawing += panel(one, time, top, no_samples);
    top += height_of(one) + kPlotGap;
  }
  top -= kPlotGap;
  drawing += time_axis(time, top);
  return formatted(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
      "role=\"img\" aria-label=\"{2}\" font-family=\"sans-serif\" font-size=\"12\" fill=\"#000\">\n<rect "
      "width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>\n{3}</svg>\n",
      kWidth, top + kTimeAxis, escaped(names), drawing);
}

}  // namespace servoctl::report
