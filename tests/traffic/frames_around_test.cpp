#include "traffic/frames_around.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace servoctl::traffic {
namespace {

/// Numbers of the frames that are shown and passed, by their times in ms; one is `!`, an occasion.
std::string shown_of(std::string_view occasion, const std::vector<std::pair<int, std::string>>& frames) {
  std::string out;
  const auto number = [](const can::LogFrame& line) { return std::to_string(line.time.count() / 1000); };
  FramesAround around(
      occasion, std::chrono::milliseconds(10), [&](const can::LogFrame& line) { out += number(line) + " "; },
      [&](const can::LogFrame& line) { out += "-" + number(line) + " "; });
  for (const auto& [time, text] : frames)
    around.add({std::chrono::milliseconds(time), "can0", *can::parse_frame(text)});
  around.end();
  return out + "(" + std::to_string(around.occasions()) + ")";
}

TEST(FramesAround, ShowsWhatWasNearAndPassesTheRestInOrder) {
  EXPECT_EQ(shown_of("emcy", {{0, "701#05"},
                              {11, "701#05"},
                              {20, "701#05"},
                              {21, "081#1081110000000000"},
                              {31, "701#05"},
                              {32, "701#05"},
                              {60, "701#05"}}),
            "-0 11 20 21 31 -32 -60 (1)");
}

TEST(FramesAround, KnowsItsOccasions) {
  EXPECT_EQ(shown_of("emcy", {{0, "081#0000000000000000"}}), "-0 (0)") << "an error reset";
  EXPECT_EQ(shown_of("abort", {{0, "581#8000200000000206"}, {50, "581#4000200000000206"}}), "0 -50 (1)");
  EXPECT_EQ(shown_of("boot-up", {{0, "701#00"}, {50, "701#05"}}), "0 -50 (1)");
  EXPECT_EQ(shown_of("error", {{0, "20000004#000C000000000000"}, {50, "004#00"}}), "0 -50 (1)");
}

}  // namespace
}  // namespace servoctl::traffic
