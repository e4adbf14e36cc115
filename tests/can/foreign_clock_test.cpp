#include "can/foreign_clock.hpp"

#include <gtest/gtest.h>

namespace servoctl::can {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// Equal but for what another quartz might have drifted since.
#define EXPECT_ABOUT(a, b) EXPECT_LE(std::chrono::abs((a) - (b)), std::chrono::microseconds(100))

TimePoint at(int time) { return TimePoint(milliseconds(time)); }

TEST(ForeignClock, FramesReadTogetherKeepTheirDistances) {
  ForeignClock clock(seconds(60));
  EXPECT_EQ(clock.time(milliseconds(100), at(5000)), at(5000));
  EXPECT_ABOUT(clock.time(milliseconds(110), at(5050)), at(5010));
  EXPECT_ABOUT(clock.time(milliseconds(130), at(5050)), at(5030));
}

TEST(ForeignClock, TheSmallestDelayCounts) {
  ForeignClock clock(seconds(60));
  EXPECT_EQ(clock.time(milliseconds(100), at(5040)), at(5040));
  EXPECT_EQ(clock.time(milliseconds(200), at(5101)), at(5101));
  EXPECT_ABOUT(clock.time(milliseconds(250), at(5200)), at(5151));
}

TEST(ForeignClock, StampsBeginAnewAfterAMinute) {
  ForeignClock clock(seconds(60));
  EXPECT_EQ(clock.time(milliseconds(59'990), at(1000)), at(1000));
  EXPECT_ABOUT(clock.time(milliseconds(10), at(1025)), at(1020));
}

TEST(ForeignClock, NoTimeLiesBehindNowOrBeforeTheLast) {
  ForeignClock clock;
  EXPECT_EQ(clock.time(seconds(1'700'000'000), at(1000)), at(1000));
  EXPECT_EQ(clock.time(seconds(1'700'000'000) - milliseconds(500), at(1010)), at(1000))
      << "the other clock was set back";
  EXPECT_EQ(clock.time(seconds(1'700'003'600), at(1020)), at(1020)) << "and forward";
  EXPECT_EQ(clock.time(seconds(1'699'000'000), at(1030)), at(1030));
}

TEST(ForeignClock, KnowsNothingOfMinutesThatPassedInSilence) {
  ForeignClock clock(seconds(60));
  clock.time(milliseconds(100), at(1000));
  EXPECT_EQ(clock.time(milliseconds(50), at(200'000)), at(200'000));
}

TEST(ForeignClock, FollowsAClockThatRunsSlower) {
  ForeignClock clock;
  TimePoint last{};
  for (int i = 0; i < 600; ++i) {
    // 100 ppm slower: 60 ms behind after ten minutes.
    const auto now = at(1000 * i);
    last = clock.time(milliseconds(1000 * i) - std::chrono::microseconds(100 * i), now);
    EXPECT_GT(last, now - milliseconds(10)) << i;
  }
}

TEST(ForeignClock, AClockThatWasSetBackALittleIsFollowedAfterASecond) {
  ForeignClock clock;
  (void)clock.time(seconds(1'000), at(1000));
  for (int i = 1; i < 100; ++i) {
    const auto now = at(1000 + 50 * i);
    const auto stamp = seconds(1'000) + milliseconds(50 * i) - milliseconds(1'500);
    const auto time = clock.time(stamp, now);
    if (i <= 45) continue;
    EXPECT_GT(time, now - milliseconds(10)) << i;
  }
}

TEST(ForeignClock, FramesThatComeInBurstsKeepTheirTimesForLong) {
  ForeignClock clock;
  (void)clock.time(seconds(1'000), at(1000));
  for (int i = 1; i < 200; ++i) {
    const auto now = at(1000 + 300 * ((i + 5) / 6));
    const auto time = clock.time(seconds(1'000) + milliseconds(50 * i), now);
    EXPECT_LT(time, at(1000 + 50 * i + 10)) << i;
  }
}

}  // namespace
}  // namespace servoctl::can
