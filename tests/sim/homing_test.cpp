// Homing along the track of the simulated axis: what it makes of speeds and switches, and what keeps it from
// home.
#include "homing_support.hpp"

namespace servoctl::sim {
namespace {

TEST_F(HomingTest, ASwitchPassedTooFastIsTakenFromTheWayBack) {
  drive().track().home = {1, 1.2, {}};
  write({0x609A, 0}, "300000");  // It needs more than the switch is wide to come to rest.
  enable("6");
  for (const auto& [method, place] :
       {std::pair(7, 0.25), {8, 1.25}, {9, 0.25}, {10, 1.25}, {24, 1.0}, {25, 1.2}})
    EXPECT_NEAR(home(method).home, place, 1e-4) << method;
}

TEST_F(HomingTest, TheHomeOffsetIsThePositionOfHome) {
  write({0x607C, 0}, "1234");
  enable("6");
  EXPECT_EQ(home(1).rest, 1234);
}

TEST_F(HomingTest, AgainAndAgainItFindsTheSamePlace) {
  enable("6");
  const auto first = home(8);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(home(8).home, first.home, 1e-4);
}

TEST_F(HomingTest, SwitchesThatScatterSpreadHomeUnlessTheIndexPulseDecides) {
  drive().track().scatter = 0.1;
  enable("6");
  const auto spread = [&](int method) {
    double least = 1e9;
    double greatest = -1e9;
    for (int i = 0; i < 3; ++i) {
      const double place = home(method).home;
      least = std::min(least, place);
      greatest = std::max(greatest, place);
    }
    return greatest - least;
  };
  EXPECT_NEAR(spread(23), 0.1, 1e-4);
  EXPECT_NEAR(spread(7), 0, 1e-4);
}

TEST_F(HomingTest, AnOffsetSpeedOfZeroIsThatOfTheSearch) {
  write({0x6099, 2}, "0");
  enable("6");
  EXPECT_NEAR(home(1).home, -1.75, 1e-4);
}

class HomingFails : public HomingTest {
 protected:
  /// It fails with bit 13, bit 10 as soon as it stands, and stands.
  void expect_failure(int method, Duration longest = 20s) {
    enable("6");
    const auto run = home(method, longest);
    EXPECT_EQ(run.statusword & (kAttained | kError), kError) << method;
    wait(500ms);
    EXPECT_EQ(status() & (kReached | kAttained | kError), kReached | kError) << method;
    EXPECT_EQ(read({0x606C, 0}), 0);
  }
};

TEST_F(HomingFails, WhereASwitchIsStuckPressed) {
  drive().track().home.stuck = true;
  expect_failure(7);  // It never comes off the switch, and meets the limit.
}

TEST_F(HomingFails, WhereTheLimitSwitchIsStuckPressed) {
  drive().track().negative_limit.stuck = true;
  expect_failure(1);
}

TEST_F(HomingFails, WhereAHomeSwitchNeverComesBetweenTheLimits) {
  drive().track().home.stuck = false;
  for (const int method : {7, 11, 23, 27}) expect_failure(method);
}

TEST_F(HomingFails, AtTheLimitWhereTheHomeSwitchIsOnTheOtherSide) {
  expect_failure(5);  // It looks to the left, the switch is on the right.
  expect_failure(22);
}

TEST_F(HomingFails, AtTheLimitWhereTheIndexPulseIsMissing) {
  drive().track().no_index = true;
  for (const int method : {1, 4, 10, 33, 34}) expect_failure(method);
}

TEST_F(HomingFails, InTheDrivesOwnTimeWhereNothingEverComes) {
  drive().track().negative_limit.stuck = false;
  enable("6");
  EXPECT_EQ(home(1, 49s).statusword & (kAttained | kError), 0U);
  expect_failure(1, 51s);
}

TEST_F(HomingFails, AtOnceWhereTheMethodIsReserved) {
  expect_failure(15, 1ms);
  expect_failure(31, 1ms);
}

TEST_F(HomingFails, AndWorksTheNextTime) {
  drive().track().home.stuck = true;
  expect_failure(7);
  drive().track().home.stuck.reset();
  const auto run = home(7);
  EXPECT_EQ(run.statusword & (kAttained | kError), kAttained);
  EXPECT_NEAR(run.home, 0.25, 1e-4);
}

TEST_F(HomingTest, InterruptedItStopsAndIsNotHomed) {
  enable("6");
  (void)home(1, 100ms);
  write({0x6040, 0}, "15");
  wait(500ms);
  EXPECT_EQ(status() & (kReached | kAttained | kError), kReached);
  EXPECT_EQ(read({0x606C, 0}), 0);
}

TEST_F(HomingTest, InAnotherModeItIsOver) {
  enable("6");
  (void)home(1, 100ms);
  write({0x6060, 0}, "3");
  wait(500ms);
  EXPECT_EQ(read({0x606C, 0}), 0);
  write({0x6060, 0}, "6");
  wait(500ms);
  EXPECT_EQ(status() & (kReached | kAttained | kError), kReached);
}

/// A method of the TS and the direction its manual tells (2189-2202).
struct TsMethod {
  int method;
  int first;
};

class TsHoming : public HomingTest, public testing::WithParamInterface<TsMethod> {
 protected:
  void SetUp() override {
    boot("ts");
    write({0x6099, 1}, "6000");
    write({0x6099, 2}, "600");
  }
};

TEST_P(TsHoming, StartsInTheDirectionItsManualTellsAndEndsHomed) {
  enable("6");
  const auto run = home(GetParam().method);
  EXPECT_EQ(run.first, GetParam().first);
  EXPECT_EQ(run.statusword & (kAttained | kError), kAttained);
}

constexpr TsMethod kTsMethods[] = {{-1, -1}, {-2, 1}, {-17, -1}, {-18, 1}, {1, -1},  {2, 1},
                                   {3, -1},  {4, 1},  {17, -1},  {18, 1},  {19, -1}, {20, 1}};
INSTANTIATE_TEST_SUITE_P(Homing, TsHoming, testing::ValuesIn(kTsMethods), [](const auto& row) {
  return std::string(row.param.method < 0 ? "minus_" : "method_") +
         std::to_string(std::abs(row.param.method));
});

TEST_F(HomingTest, TheInputsTellTheSwitches) {
  const auto pressed_at = [&](double place) {
    stand_at(place - from_);
    from_ = place;
    return read({0x60FD, 0});
  };
  EXPECT_EQ(pressed_at(0), 0);
  EXPECT_EQ(pressed_at(-2.5), 1);
  EXPECT_EQ(pressed_at(7), 2);
  EXPECT_EQ(pressed_at(2), 4);
}

}  // namespace
}  // namespace servoctl::sim
