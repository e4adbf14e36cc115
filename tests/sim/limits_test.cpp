// Internal limits (bit 11 of the statusword): the rows the manuals print of them, and CiA 402-2.
#include "manual_rows.hpp"
#include "sim_support.hpp"

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;
using drive::DriveState;

class Limits : public RowTest {};

TEST_F(Limits, OfTheGsd600InInterpolatedPositionAreReached) {
  boot("gsd600");
  // RPDO2 carries 60C1h:01, by type 1 (6198, 7479).
  for (const char* request : {"601#2301140101030080", "601#2F01160000000000", "601#230116012001C160",
                              "601#2F01160001000000", "601#2F01140201000000", "601#2301140101030000"})
    ASSERT_EQ(sdo(request).substr(0, 6), "581#60") << request;
  send("000#0101");
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
  send("301#400D0300");  // 200000
  send("080#");
  expect_row("ip", 7506, "7", kOf);
  EXPECT_EQ(read(kPosition), 131072);
  control("15");
  expect_row("ip", 7502, "3", kOf);
  control("31");
  send("301#B03CFFFF");  // -50000
  send("080#");
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

class StandardLimits : public StandardTest {};

TEST_F(StandardLimits, LimitSwitchesStopTheAxisWhereTheyAreObeyed) {
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

TEST_F(StandardLimits, LimitSwitchesAreIgnoredFromTheFactory) {
  enable("3");
  write(kVelocity, "20000");
  wait(5s);
  EXPECT_GT(read(kPosition), 60000);
  EXPECT_EQ(status() & kLimit, 0U);
  EXPECT_EQ(read({0x60FD, 0}), 2);
}

TEST_F(StandardLimits, LimitsOfNothingAreNone) {  // 607Dh with both at 0
  stop_at("0", "0");
  enable("1");
  go("20000");
  EXPECT_TRUE(reaches(kReached, kReached));
  EXPECT_EQ(read(kPosition), 20000);
  EXPECT_EQ(status() & kLimit, 0U);
}

TEST_F(StandardLimits, SoftwareLimitsStopATargetBeyondThem) {  // 607Dh
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
