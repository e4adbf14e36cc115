#include "report/svg.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/text.hpp"
#include "report/markup.hpp"

namespace servoctl::report {
namespace {

std::size_t count(std::string_view text, std::string_view what) {
  std::size_t out = 0;
  for (auto at = text.find(what); at != std::string_view::npos; at = text.find(what, at + 1)) ++out;
  return out;
}

std::string plot(std::vector<Series> series) { return svg_plot(series); }

TEST(Escaped, LetsNothingBecomeMarkup) {
  EXPECT_EQ(escaped("<img src=x onerror=\"alert('1')\"> & co"),
            "&lt;img src=x onerror=&quot;alert(&#39;1&#39;)&quot;&gt; &amp; co");
  EXPECT_EQ(escaped("位置"), "位置");
}

TEST(Escaped, IsValidInXmlWhateverTheBytes) {
  EXPECT_EQ(escaped(std::string_view("a\0b\x1b", 4)), "a\\x00b\\x1B");
  EXPECT_EQ(escaped("\xFF\xC3("), "\\xFF\\xC3(");
  EXPECT_EQ(escaped("\xE0\x80\xBC"), "\\xE0\\x80\\xBC") << "an overlong <";
  EXPECT_EQ(escaped("\xED\xA0\x80"), "\\xED\\xA0\\x80") << "a surrogate";
  EXPECT_EQ(escaped("\xEF\xBF\xBF"), "\\uFFFF") << "U+FFFF is no character of XML";
}

TEST(SvgPlot, DrawsEachQuantityOverOneTime) {
  const auto svg = plot({{"position", "deg", {0, 1, 2}, {0, 50, 100}}, {"torque", "%", {0, 2}, {-3, 3}}});
  EXPECT_TRUE(svg.starts_with("<svg xmlns="));
  EXPECT_EQ(count(svg, "<polyline"), 2U);
  EXPECT_NE(svg.find(">position (deg)<"), std::string::npos);
  EXPECT_NE(svg.find("points=\"72.0,134.0 390.0,78.0 708.0,22.0\""), std::string::npos) << svg;
  EXPECT_EQ(count(svg, ">s<"), 1U);
}

TEST(SvgPlot, BreaksTheLineWhereThereIsNoNumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(count(plot({{"x", "", {0, 1, 2, 3, 4}, {1, 2, nan, 2, 1}}}), "<polyline"), 2U);
  const auto nothing = plot({{"x", "", {0}, {nan}}});
  EXPECT_EQ(count(nothing, "<polyline"), 0U);
  EXPECT_NE(nothing.find("x: no samples"), std::string::npos);
  EXPECT_EQ(plot({}), "");
}

TEST(SvgPlot, DrawsASingleSampleAsADot) {
  EXPECT_EQ(count(plot({{"x", "", {5}, {7}}}), "<polyline points=\"72.0,78.0 72.0,78.0\"/>"), 1U);
}

TEST(SvgPlot, KeepsPeaksOfManySamplesAndStaysSmall) {
  Series series{"x", "", {}, {}};
  for (int i = 0; i < 200000; ++i) {
    series.seconds.push_back(i * 1e-4);
    series.values.push_back(i == 123456 ? 10 : 0);
  }
  const auto svg = plot({series});
  EXPECT_LT(svg.size(), 80000U);
  EXPECT_NE(svg.find(",22.0"), std::string::npos) << "the peak reaches the top";
}

TEST(SvgPlot, EscapesNames) {
  const auto svg = plot({{"<script>", "\"", {0}, {1}}});
  EXPECT_EQ(svg.find("<script>"), std::string::npos);
  EXPECT_NE(svg.find("&lt;script&gt; (&quot;)"), std::string::npos);
}

}  // namespace
}  // namespace servoctl::report
