// What the looks at a turning motor tell of its counts.
#include "motion/turn_estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace servoctl::motion {
namespace {

using namespace std::chrono_literals;

std::vector<TurnLook> looks(double counts, double rpm, int number = 100) {
  std::vector<TurnLook> out;
  for (int i = 0; i < number; ++i) {
    const double seconds = i * 0.02;
    out.push_back({TimePoint{} + std::chrono::milliseconds(20 * i), counts * rpm / 60 * seconds,
                   counts * rpm / 60, rpm});
  }
  return out;
}

TEST(TurnEstimate, IsTheWayOverTheTurns) {
  const auto found = measure_turn(looks(131072, 30), 0.1);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->increments, 131072, 1);
  EXPECT_NEAR(found->uncertainty, 0.1 / 30, 1e-6);
  EXPECT_NEAR(found->by_speed, 131072, 1);
}

TEST(TurnEstimate, FollowsAPositionOverTheEndOfItsRange) {
  auto over = looks(8388608, 30);
  for (auto& look : over) {
    look.position += 2147483000;
    if (look.position > 2147483647) look.position -= 4294967296.0;
  }
  const auto found = measure_turn(over, 0.1);
  ASSERT_TRUE(found) << found.error().message.text();
  EXPECT_NEAR(found->increments, 8388608, 10);
}

TEST(TurnEstimate, RefusesWhatIsNotExactEnough) {
  EXPECT_FALSE(measure_turn(looks(131072, 30, 40), 0.1)) << "too few";
  EXPECT_FALSE(measure_turn(looks(131072, 9), 0.1)) << "one step is more than 1 %";
  EXPECT_FALSE(measure_turn(looks(131072, 0), 0.1));
  auto quarrel = looks(131072, 30);
  for (auto& look : quarrel) look.speed *= 1.03;
  const auto found = measure_turn(quarrel, 0.1);
  ASSERT_FALSE(found);
  EXPECT_NE(found.error().message.text().find("reports two speeds"), std::string::npos);
}

TEST(TurnEstimate, TakesWhatIsWithinOnePercent) {
  EXPECT_EQ(counts_behind(131072 * 1.0099, 0.003, {})->counts, 131072);
  EXPECT_EQ(counts_behind(131072 / 1.0098, 0.003, {})->counts, 131072);
  EXPECT_FALSE(counts_behind(131072 * 1.011, 0.003, {}));
  EXPECT_EQ(counts_behind(8390000, 0.003, {})->counts, 8388608) << "a power of two goes before 8400000";
  EXPECT_EQ(counts_behind(9950, 0.003, {})->counts, 10000);
  EXPECT_EQ(counts_behind(36100, 0.003, {})->counts, 36000);
  EXPECT_FALSE(counts_behind(10 * 131072, 0.003, {})) << "ten times a power of two is none";
}

}  // namespace
}  // namespace servoctl::motion
