#include "report/plot.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "base/text.hpp"
#include "report/axis.hpp"

namespace servoctl::report {
namespace {

Series ramp(std::string name, std::string unit, double from, double to, std::size_t count = 100) {
  Series out{std::move(name), std::move(unit), {}, {}};
  for (std::size_t i = 0; i < count; ++i) {
    out.seconds.push_back(0.02 * static_cast<double>(i));
    out.values.push_back(from + (to - from) * static_cast<double>(i) / static_cast<double>(count - 1));
  }
  return out;
}

std::string drawn(std::vector<Series> series, std::size_t width = kPlotWidth) {
  return braille_plot(series, width);
}

TEST(Ticks, StandAtRoundNumbersWithinTheExtent) {
  EXPECT_EQ(ticks_of({0, 60}, 4).at, (std::vector<double>{0, 20, 40, 60}));
  EXPECT_EQ(ticks_of({-3, 3}, 4).at, (std::vector<double>{-2, 0, 2}));
  const auto small = ticks_of({0, 0.0007}, 5);
  ASSERT_EQ(small.at.size(), 4U);
  EXPECT_EQ(small.text(small.at[1]), "0.0002");
  EXPECT_EQ(ticks_of({0, 1}, 3).text(0.5), "0.5");
  EXPECT_EQ(ticks_of({-1, 1}, 3).text(-1e-17), "0");
}

TEST(Axis, BeginsAndEndsAtAMark) {
  const auto axis = axis_of({-3, 57}, 4);
  EXPECT_DOUBLE_EQ(axis.extent.low, -20);
  EXPECT_DOUBLE_EQ(axis.extent.high, 60);
  EXPECT_EQ(axis.ticks.at, (std::vector<double>{-20, 0, 20, 40, 60}));
}

TEST(BraillePlot, ShowsARampWithItsAxes) {
  EXPECT_EQ(drawn({ramp("velocity", "rpm", 0, 60)}, 40),
            "velocity (rpm)\n"
            "60 ┤                                ⢀⠤⠒⠋\n"
            "   │                            ⣀⠤⠖⠋⠁\n"
            "   │                        ⣀⠤⠖⠉\n"
            "40 ┤                    ⣀⠤⠒⠉\n"
            "   │                ⣀⠤⠒⠉\n"
            "20 ┤            ⣀⠤⠒⠉\n"
            "   │        ⣀⠴⠒⠉\n"
            "   │   ⢀⣠⠴⠒⠉\n"
            " 0 ┤⣠⠤⠒⠁\n"
            "   └┴─────────────────┴─────────────────\n"
            "s   0                 1\n");
}

TEST(BraillePlot, StacksQuantitiesOverOneTime) {
  auto late = ramp("torque", "%", -3, 3);
  for (auto& second : late.seconds) second += 2;
  const auto text = drawn({ramp("position", "deg", 0, 12345), late});
  EXPECT_NE(text.find("position (deg)\n"), std::string::npos);
  EXPECT_NE(text.find("torque (%)\n"), std::string::npos);
  EXPECT_EQ(text.find("└"), text.rfind("└")) << "one time axis for both";
  for (const auto line : split(std::string_view(text), '\n')) EXPECT_LE(display_width(line), 80U) << line;
}

TEST(BraillePlot, DrawsAConstantAndASingleSample) {
  const auto constant = drawn({ramp("mode", "", 3, 3)});
  EXPECT_NE(constant.find("3.0 ┤⠤⠤⠤⠤"), std::string::npos) << constant;
  const auto single = drawn({{"position", "deg", {0}, {90}}});
  EXPECT_NE(single.find("position (deg)\n"), std::string::npos);
  EXPECT_EQ(single.find("no samples"), std::string::npos);
}

TEST(BraillePlot, LeavesAGapWhereThereIsNoNumber) {
  auto series = ramp("torque", "%", 5, 5);
  for (std::size_t i = 40; i < 60; ++i) series.values[i] = std::numeric_limits<double>::quiet_NaN();
  const auto text = drawn({series});
  EXPECT_NE(text.find("┤⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒⠒               ⠒⠒"), std::string::npos) << text;
}

TEST(BraillePlot, SaysThatThereAreNoSamples) {
  EXPECT_EQ(drawn({}), "");
  EXPECT_EQ(drawn({{"torque", "%", {}, {}}}), "torque (%): no samples\n");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(drawn({{"torque", "%", {0, 1}, {nan, nan}}}), "torque (%): no samples\n");
  EXPECT_EQ(drawn({{"torque", "%", {nan}, {1}}}), "torque (%): no samples\n");
}

TEST(BraillePlot, StandsNumbersOfEverySize) {
  const double largest = std::numeric_limits<double>::max();
  for (const auto& values : {std::vector<double>{-largest, largest}, std::vector<double>{1e299, -1e299},
                             std::vector<double>{1e-310, 2e-310}, std::vector<double>{1e15, 1e15 + 1},
                             std::vector<double>{0, INFINITY, -INFINITY}}) {
    const auto text = drawn({{"x", "", std::vector<double>(values.size(), 7.0), values}});
    for (const auto line : split(std::string_view(text), '\n')) EXPECT_LE(display_width(line), 80U) << line;
  }
}

TEST(BraillePlot, WritesOutControlCharactersOfAName) {
  const auto text = drawn({{"bad\x1b[2J", "", {0}, {1}}});
  EXPECT_EQ(text.find('\x1b'), std::string::npos);
}

}  // namespace
}  // namespace servoctl::report
