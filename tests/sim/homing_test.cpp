// Homing along the track of the simulated axis: where each method ends, and what keeps it from it.
#include <cmath>

#include "sim_support.hpp"

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;

constexpr unsigned kReached = 1U << 10U;
constexpr unsigned kAttained = 1U << 12U;
constexpr unsigned kError = 1U << 13U;

constexpr double kTurn = 10000;  // Increments and pulses in one turn.

/// What a run was seen to do.
struct Homed {
  unsigned statusword = 0;
  double home = 0;         ///< In turns from where the axis stood at first.
  double rest = 0;         ///< 6064h at its end.
  int first = 0;           ///< Direction in which it began.
  int last = 0;            ///< Direction in which it came to its end.
  double fastest_end = 0;  ///< Turns a second when it came there.
};

class HomingTest : public DrivenTest {
 protected:
  void SetUp() override { start("cia402"); }

  void start(const std::string& family) {
    boot(family);
    write({0x608F, 1}, "10000");
    write({0x6092, 1}, "10000");
    write({0x6099, 1}, "100000");
    write({0x6099, 2}, "10000");
    write({0x609A, 0}, "1000000");
    drive().track() = {.negative_limit = {-Track::kFar, -2, {}},
                       .positive_limit = {6, Track::kFar, {}},
                       .home = {1, 3.5, {}}};
  }
  /// The axis stands here at first.
  void stand_at(double place) {
    auto& track = drive().track();
    for (auto* one : {&track.negative_limit, &track.positive_limit, &track.home}) {
      one->from -= place;
      one->to -= place;
    }
    track.index -= place;
    from_ = place;
  }
  Homed home(int method, Duration longest = 20s) {
    write({0x6098, 0}, std::to_string(method));
    write({0x6040, 0}, "15");
    write({0x6040, 0}, "31");
    Homed run;
    const auto end = bus.now() + longest;
    while (bus.now() < end) {
      run.statusword = status();
      const double speed = read({0x606C, 0}) / kTurn;
      const int sign = speed > 0 ? 1 : speed < 0 ? -1 : 0;
      if (run.first == 0) run.first = sign;
      if ((run.statusword & (kAttained | kError)) != 0) break;
      if (sign != 0) run.last = sign;
      if (sign != 0) run.fastest_end = std::abs(speed);
      (void)next(1ms);
    }
    run.rest = read({0x6064, 0});
    run.home = from_ + (read({0x6063, 0}) - read({0x6064, 0})) / kTurn;
    return run;
  }

  double from_ = 0;
};

/// A picture of CiA 402-2: from where the axis starts, how it begins, where it finds home and in which
/// direction. The home switch is pressed from 1 to 3.5, limits stand at -2 and 6, pulses come at x.25.
struct Picture {
  int method;
  double from;
  int first;
  int last;
  double home;
};

class Pictures : public HomingTest, public testing::WithParamInterface<Picture> {};

TEST_P(Pictures, OfTheStandardEndWhereTheyAreDrawn) {
  const auto& picture = GetParam();
  stand_at(picture.from);
  enable("6");
  const auto run = home(picture.method);
  EXPECT_EQ(run.statusword & (kReached | kAttained | kError), kReached | kAttained)
      << std::hex << run.statusword;
  EXPECT_NEAR(run.home, picture.home, 1e-4);
  EXPECT_EQ(run.rest, 0);
  EXPECT_EQ(run.first, picture.first);
  EXPECT_EQ(run.last, picture.last);
  EXPECT_LE(run.fastest_end, 1.001) << "it is found at the slow speed";
}

constexpr Picture kPictures[] = {
    {1, 0, -1, 1, -1.75},  {1, -3, 1, 1, -1.75},  // Negative limit, pulse.
    {2, 0, 1, -1, 5.25},   {2, 7, -1, -1, 5.25},  // Positive limit, pulse.
    {3, 0, 1, -1, 0.25},   {3, 2, -1, -1, 0.25},  // Home switch to the right.
    {4, 0, 1, 1, 1.25},    {4, 2, -1, 1, 1.25},     {5, 5, -1, 1, 4.25},
    {5, 2, 1, 1, 4.25},  // Home switch to the left.
    {6, 5, -1, -1, 3.25},  {6, 2, 1, -1, 3.25},     {7, 0, 1, -1, 0.25},
    {7, 2, -1, -1, 0.25},  {7, 5, 1, -1, 0.25},                          // Home switch in between, first
    {8, 0, 1, 1, 1.25},    {8, 2, -1, 1, 1.25},     {8, 5, 1, 1, 1.25},  // to the positive limit.
    {9, 0, 1, -1, 3.25},   {9, 2, 1, -1, 3.25},     {9, 5, 1, -1, 3.25},
    {10, 0, 1, 1, 4.25},   {10, 2, 1, 1, 4.25},     {10, 5, 1, 1, 4.25},
    {11, 5, -1, 1, 4.25},  {11, 2, 1, 1, 4.25},     {11, 0, -1, 1, 4.25},  // First to the negative limit.
    {12, 5, -1, -1, 3.25}, {12, 2, 1, -1, 3.25},    {12, 0, -1, -1, 3.25},
    {13, 5, -1, 1, 1.25},  {13, 2, -1, 1, 1.25},    {13, 0, -1, 1, 1.25},
    {14, 5, -1, -1, 0.25}, {14, 2, -1, -1, 0.25},   {14, 0, -1, -1, 0.25},
    {17, 0, -1, 1, -2},    {17, -3, 1, 1, -2},  // The same without the pulse.
    {18, 0, 1, -1, 6},     {18, 7, -1, -1, 6},      {19, 0, 1, -1, 1},
    {19, 2, -1, -1, 1},    {20, 0, 1, 1, 1},        {20, 2, -1, 1, 1},
    {21, 5, -1, 1, 3.5},   {21, 2, 1, 1, 3.5},      {22, 5, -1, -1, 3.5},
    {22, 2, 1, -1, 3.5},   {23, 0, 1, -1, 1},       {23, 2, -1, -1, 1},
    {23, 5, 1, -1, 1},     {24, 0, 1, 1, 1},        {24, 2, -1, 1, 1},
    {24, 5, 1, 1, 1},      {25, 0, 1, -1, 3.5},     {25, 2, 1, -1, 3.5},
    {25, 5, 1, -1, 3.5},   {26, 0, 1, 1, 3.5},      {26, 2, 1, 1, 3.5},
    {26, 5, 1, 1, 3.5},    {27, 5, -1, 1, 3.5},     {27, 2, 1, 1, 3.5},
    {27, 0, -1, 1, 3.5},   {28, 5, -1, -1, 3.5},    {28, 2, 1, -1, 3.5},
    {28, 0, -1, -1, 3.5},  {29, 5, -1, 1, 1},       {29, 2, -1, 1, 1},
    {29, 0, -1, 1, 1},     {30, 5, -1, -1, 1},      {30, 2, -1, -1, 1},
    {30, 0, -1, -1, 1},    {33, 0.5, -1, -1, 0.25}, {34, 0.5, 1, 1, 1.25},  // The pulse alone.
    {35, 0.5, 0, 0, 0.5},  {37, 0.5, 0, 0, 0.5},                            // Where it stands.
};

INSTANTIATE_TEST_SUITE_P(Homing, Pictures, testing::ValuesIn(kPictures), [](const auto& row) {
  const auto tenths = std::to_string(std::abs(static_cast<int>(row.param.from * 10)));
  return "method_" + std::to_string(row.param.method) + "_from_" + (row.param.from < 0 ? "minus_" : "") +
         tenths;
});

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
