// Errors in motion (bit 13 of the statusword): the rows the manuals print of them, and CiA 402-2.
#include "manual_rows.hpp"

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;
using drive::DriveState;

class InMotion : public RowTest {
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
  obey_switches();
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
  expect_alarm("pp", 943, "5", "0085211600");  // Er22-0: bytes 3 and 4 are 22 and 0 (336).
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

class StandardErrors : public StandardTest {};

TEST_F(StandardErrors, AFollowingErrorMustLastForItsTime) {  // 6066h
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

TEST_F(StandardErrors, AWindowOfAllOnesIsNone) {  // 6065h
  write({0x6065, 0}, "0xFFFFFFFF");
  drive().axis_faults().stalled = true;
  enable("1");
  go("1000000");
  wait(10s);
  EXPECT_EQ(status() & kError, 0U);
}

}  // namespace
}  // namespace servoctl::sim
