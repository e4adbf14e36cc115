// Internal limits (bit 11) and errors in motion (bit 13): the rows the manuals print of them, and CiA 402-2.
#include <cstdlib>

#include "manual_rows.hpp"
#include "sim_support.hpp"

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;
using drive::DriveState;

constexpr unsigned kReached = 1U << 10U;
constexpr unsigned kLimit = 1U << 11U;
constexpr unsigned kError = 1U << 13U;

constexpr ObjectAddress kControlword{0x6040, 0};
constexpr ObjectAddress kMode{0x6060, 0};
constexpr ObjectAddress kTarget{0x607A, 0};
constexpr ObjectAddress kLower{0x607D, 1};
constexpr ObjectAddress kUpper{0x607D, 2};
constexpr ObjectAddress kPosition{0x6064, 0};
constexpr ObjectAddress kVelocity{0x60FF, 0};
constexpr ObjectAddress kPoint{0x60C1, 1};

class Limits : public DrivenTest {
 protected:
  /// The row of the manual comes; `of` are the bits that are looked at where the row prints more.
  void expect_row(const std::string& mode, unsigned line, const std::string& step, unsigned of = 0xFFFF) {
    for (const auto& row : manual_rows(family_, mode, line, line))
      if (row.step == step) {
        EXPECT_TRUE(reaches(row.statusword, row.mask & of))
            << mode << " line " << line << ": " << std::hex << status() << " for " << row.statusword;
        return;
      }
    ADD_FAILURE() << "the manual has no row " << mode << " " << line << " " << step;
  }
  void control(std::string_view word) { write(kControlword, word); }
  void stop_at(std::string_view lower, std::string_view upper) {
    write(kLower, lower);
    write(kUpper, upper);
  }
};

TEST_F(Limits, OfTheGsd600InInterpolatedPositionAreReached) {
  boot("gsd600");
  enable("6");
  write({0x6098, 0}, "35");
  control("31");
  ASSERT_TRUE(reaches(0x1400, 0x3400));
  control("15");
  write({0x6083, 0}, "1310720");
  stop_at("-131072", "131072");
  write(kMode, "7");
  // They act after homing (5796), so bit 15 is set; the rows print it clear.
  constexpr unsigned kOf = 0x7FFF;
  expect_row("ip", 7500, "1", kOf);
  write(kPoint, "200000");
  expect_row("ip", 7501, "2", kOf);
  control("31");
  expect_row("ip", 7505, "6", kOf);
  expect_row("ip", 7506, "7", kOf);
  EXPECT_EQ(read(kPosition), 131072);
  control("15");
  expect_row("ip", 7502, "3", kOf);
  write(kPoint, "-50000");
  control("31");
  expect_row("ip", 7503, "4", kOf);
  expect_row("ip", 7504, "5", kOf);
  EXPECT_EQ(read(kPosition), -50000);
}

TEST_F(Limits, OfTheGsd600ActOnlyOnceItIsHomedAndLetItBack) {  // 5796
  boot("gsd600");
  stop_at("-131072", "131072");
  write({0x6081, 0}, "1310720");
  const auto move = [&](std::string_view target) {
    write(kTarget, target);
    control("15");
    control("31");
    EXPECT_TRUE(reaches(kReached, kReached));
  };
  enable("1");
  move("300000");
  EXPECT_EQ(read(kPosition), 300000);
  move("0");
  write(kMode, "6");
  write({0x6098, 0}, "35");
  control("15");
  control("31");
  ASSERT_TRUE(reaches(0x1400, 0x3400));
  write(kMode, "1");
  move("300000");
  EXPECT_EQ(read(kPosition), 131072);
  EXPECT_EQ(status() & kLimit, kLimit);
  move("100000");
  EXPECT_EQ(read(kPosition), 100000);
  EXPECT_EQ(status() & kLimit, 0U);
}

class Sv2Limits : public Limits {
 protected:
  void SetUp() override {
    boot("sv2");
    stop_at("-20000", "20000");
    write({0x2005, 2}, "1");  // 599
  }
};

TEST_F(Sv2Limits, InCyclicPositionAreReached) {
  enable("8");
  expect_row("csp", 965, "5");
  expect_row("csp", 963, "2");
  write(kTarget, "10000");
  expect_row("csp", 963, "3");
  expect_row("csp", 963, "2");
  EXPECT_EQ(status() & kLimit, 0U);
  write(kTarget, "30000");
  expect_row("csp", 964, "4");
  ASSERT_TRUE(reaches(kReached, kReached));
  EXPECT_EQ(read(kPosition), 20000);
  control("6");
  expect_row("csp", 965, "6");
}

TEST_F(Sv2Limits, InProfileVelocityAreReached) {
  enable("3");
  write(kVelocity, "10000");
  expect_row("pv", 1116, "2");
  expect_row("pv", 1117, "3");
  EXPECT_EQ(read(kPosition), 20000);
  EXPECT_EQ(read({0x606C, 0}), 0);
  write(kVelocity, "-10000");
  EXPECT_TRUE(reaches(kReached, kReached | kLimit)) << "it may go back";
}

TEST_F(Sv2Limits, InProfileTorqueAreReached) {
  enable("4");
  write({0x6071, 0}, "100");
  expect_row("pt", 1165, "2");
  expect_row("pt", 1166, "3");
  EXPECT_EQ(read(kPosition), 20000);
  wait(1s);
  EXPECT_EQ(read(kPosition), 20000);
}

TEST_F(Sv2Limits, AreNoneUntilTheyAreSwitchedOn) {  // 599
  write({0x2005, 2}, "0");
  enable("3");
  write(kVelocity, "100000");
  wait(2s);
  EXPECT_GT(read(kPosition), 20000);
  EXPECT_EQ(status() & kLimit, 0U);
}

class InMotion : public Limits {
 protected:
  /// A following error: bit 13, the alarm of the family, and no power.
  void expect_alarm(const std::string& mode, unsigned line, const std::string& step, std::string_view alarm) {
    expect_row(mode, line, step);
    wait(50ms);
    EXPECT_EQ(drive().power_state(), DriveState::fault);
    EXPECT_EQ(emergency_.substr(0, 4 + alarm.size()), "081#" + std::string(alarm));
    expect_row(mode, line, step);
  }
};

TEST_F(InMotion, OfTheSv2APositionErrorIsItsAlarmFour) {  // 966, 1034, 1398
  boot("sv2");
  drive().axis_faults().stalled = true;
  enable("8");
  write(kTarget, "100000");
  expect_alarm("csp", 966, "7", "1186");
  write({0x2005, 1}, "1");
  EXPECT_EQ(status() & kError, 0U) << "it is cleared with the fault";
  write(kMode, "1");
  for (const auto* word : {"6", "7", "15"}) control(word);
  write(kTarget, "200000");
  control("31");
  expect_alarm("pp", 1034, "5", "1186");
}

TEST_F(InMotion, OfTheSv2ProfilePositionIsToldAsPrinted) {
  boot("sv2");
  enable("1");
  expect_row("pp", 1032, "2");
  expect_row("pp", 1033, "3");
  write(kTarget, "30000");
  control("31");
  expect_row("pp", 1033, "4");
  control("15");
  expect_row("pp", 1032, "2");
}

TEST_F(InMotion, OfTheSv2HomingIsToldAsPrinted) {
  boot("sv2");
  enable("6");
  control("31");
  expect_row("hm", 1220, "5");
  expect_row("hm", 1220, "6");
  expect_row("hm", 1219, "4");
  drive().track().negative_limit.stuck = false;
  control("15");
  control("31");
  wait(51s);
  expect_row("hm", 1221, "7");  // Timeout.
}

TEST_F(InMotion, OfTheSv2ADeviationWhileHomingIsAHomingError) {
  boot("sv2");
  drive().axis_faults().stalled = true;
  enable("6");
  control("31");
  expect_alarm("hm", 1221, "7", "1186");
}

TEST_F(InMotion, OfTheDa200HomingIsToldAsPrinted) {
  boot("da200");
  write({0x6098, 0}, "17");
  write({0x6099, 1}, "300");
  write({0x6099, 2}, "60");
  enable("6");
  control("31");
  expect_row("hm", 574, "5");
  drive().track().negative_limit.stuck = true;
  drive().track().positive_limit.stuck = true;
  control("15");
  control("31");
  expect_row("hm", 574, "6");
}

TEST_F(InMotion, OfTheDa200APositionErrorIsItsAlarm22) {  // 943, 1148
  boot("da200");
  write({0x6065, 0}, "10000");
  write({0x6081, 0}, "300");
  drive().axis_faults().stalled = true;
  enable("1");
  write(kTarget, "100000");
  control("31");
  expect_alarm("pp", 943, "5", "0085811600");  // Er22-0: bytes 3 and 4 are 22 and 0 (336).
}

TEST_F(InMotion, OfTheDa200SlippageIsTold) {  // 654, 943
  boot("da200");
  write({0x60F8, 0}, "50");
  drive().axis_faults().stalled = true;
  enable("3");
  write(kVelocity, "40");
  wait(1s);
  EXPECT_EQ(status() & kError, 0U);
  write(kVelocity, "60");
  expect_row("pv", 943, "3");
}

class Standard : public Limits {
 protected:
  void SetUp() override {
    boot("cia402");
    write({0x6081, 0}, "10000");
    write({0x6083, 0}, "100000");
  }
  void go(std::string_view target) {
    write(kTarget, target);
    control("15");
    control("31");
  }
};

TEST_F(Standard, AFollowingErrorMustLastForItsTime) {  // 6066h
  write({0x6065, 0}, "1000");
  write({0x6066, 0}, "500");
  drive().axis_faults().stalled = true;
  enable("1");
  go("100000");
  wait(550ms);
  EXPECT_EQ(status() & kError, 0U);
  EXPECT_TRUE(reaches(kError, kError));
  wait(50ms);
  EXPECT_EQ(drive().power_state(), DriveState::fault);
  EXPECT_EQ(emergency_.substr(0, 8), "081#1186");
}

TEST_F(Standard, AWindowOfAllOnesIsNone) {  // 6065h
  write({0x6065, 0}, "0xFFFFFFFF");
  drive().axis_faults().stalled = true;
  enable("1");
  go("1000000");
  wait(10s);
  EXPECT_EQ(status() & kError, 0U);
}

TEST_F(Standard, LimitSwitchesStopTheAxisWhereTheyAreObeyed) {
  drive().track().limits_stop = true;
  enable("3");
  write(kVelocity, "20000");
  EXPECT_TRUE(reaches(kLimit, kLimit));
  wait(1s);
  EXPECT_EQ(read({0x606C, 0}), 0);
  EXPECT_NEAR(read(kPosition), 40000, 3000);  // The switch, and the way to rest.
  write(kVelocity, "-20000");
  EXPECT_TRUE(reaches(0, kLimit));
}

TEST_F(Standard, LimitSwitchesAreIgnoredFromTheFactory) {
  enable("3");
  write(kVelocity, "20000");
  wait(5s);
  EXPECT_GT(read(kPosition), 60000);
  EXPECT_EQ(status() & kLimit, 0U);
  EXPECT_EQ(read({0x60FD, 0}), 2);
}

TEST_F(Standard, LimitsOfNothingAreNone) {  // 607Dh with both at 0
  stop_at("0", "0");
  enable("1");
  go("20000");
  EXPECT_TRUE(reaches(kReached, kReached));
  EXPECT_EQ(read(kPosition), 20000);
  EXPECT_EQ(status() & kLimit, 0U);
}

TEST_F(Standard, SoftwareLimitsStopATargetBeyondThem) {  // 607Dh
  stop_at("-5000", "5000");
  enable("1");
  go("20000");
  EXPECT_TRUE(reaches(kReached | kLimit, kReached | kLimit));
  EXPECT_EQ(read(kPosition), 5000);
  go("-20000");
  EXPECT_TRUE(reaches(0, kLimit));
  EXPECT_TRUE(reaches(kReached | kLimit, kReached | kLimit));
  EXPECT_EQ(read(kPosition), -5000);
}

}  // namespace
}  // namespace servoctl::sim
