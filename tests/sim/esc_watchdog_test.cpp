// What a simulated drive on EtherCAT does when its process data end: the watchdog of its outputs, and OP left
// with power.
#include "esc_process_data_support.hpp"

namespace servoctl::sim {
namespace {

using std::chrono::milliseconds;

class EscWatchdogTest : public EscProcessDataTest {};

TEST_F(EscWatchdogTest, SilenceOfAHundredMillisecondsEndsOpAndRaisesTheAlarm) {
  start();
  preset();
  EXPECT_EQ(exchange(), 3);
  ASSERT_EQ(request(8), "08 00 00 00 00 00");
  enable();
  out.velocity = 20000;
  cycle(milliseconds(500));
  EXPECT_EQ(show(0x0440, 3), "01 00 00");
  run(milliseconds(99));
  EXPECT_EQ(slave().state(), EscState::op);
  EXPECT_TRUE(drive::is_energised(slave().model().power_state()));
  run(milliseconds(1));
  EXPECT_EQ(al(), "14 00 00 00 1B 00");
  EXPECT_EQ(show(0x0440, 3), "00 00 01");
  run(milliseconds(100));
  EXPECT_FALSE(drive::is_energised(slave().model().power_state()));
  EXPECT_EQ(slave().model().power_state(), drive::DriveState::fault);
  EXPECT_EQ(sdo("40 3F60 00 00000000"), "00 10 00 75 01 00 00 00 00 00");  // First the emergency.
  EXPECT_EQ(fetch_data().substr(18), "00 75 00 00");
  EXPECT_EQ(request(8), "14 00 00 00 1B 00");  // Not acknowledged.
  EXPECT_EQ(exchange(), 3);
  EXPECT_EQ(request(0x18), "08 00 00 00 00 00");
  out.controlword = 0x80;
  cycle(5 * kCycle);
  EXPECT_EQ(statusword() & 0x4FU, 0x40U);
}

TEST_F(EscWatchdogTest, TheWatchdogFollowsItsRegisters) {
  start_op();
  EXPECT_EQ(write(0x0420, store_le(50, 2)), 1);
  EXPECT_EQ(exchange(), 3);
  run(milliseconds(5) - Duration(1));
  EXPECT_EQ(slave().state(), EscState::op);
  run(Duration(1));
  EXPECT_EQ(slave().state(), EscState::safe_op);
  EXPECT_EQ(write(0x0400, store_le(4998, 2)), 1);  // 200 us a step.
  EXPECT_EQ(exchange(), 3);
  ASSERT_EQ(request(0x18), "08 00 00 00 00 00");
  run(milliseconds(10) - Duration(1));
  EXPECT_EQ(slave().state(), EscState::op);
  run(Duration(1));
  EXPECT_EQ(slave().state(), EscState::safe_op);
  EXPECT_EQ(show(0x0442, 1), "02");
  EXPECT_EQ(write(0x0442, "00"), 1);
  EXPECT_EQ(show(0x0442, 1), "00");
}

TEST_F(EscWatchdogTest, TheWatchdogIsOffByCountZeroAndByTheControlOfItsSyncManager) {
  start_op();
  EXPECT_EQ(write(0x0420, "0000"), 1);
  EXPECT_EQ(exchange(), 3);
  run(std::chrono::seconds(5));
  EXPECT_EQ(al(), "08 00 00 00 00 00");
  EXPECT_EQ(show(0x0440, 1), "01");
  EXPECT_EQ(request(2), "02 00 00 00 00 00");
  EXPECT_EQ(write(0x0420, store_le(1000, 2)), 1);
  EXPECT_EQ(write(0x0816, "00"), 1);
  EXPECT_EQ(write(0x0810, "0018 1300 24 00 01 00"), 1);
  EXPECT_EQ(request(0x14), "04 00 00 00 00 00");
  EXPECT_EQ(exchange(), 3);
  EXPECT_EQ(request(8), "08 00 00 00 00 00");
  run(std::chrono::seconds(5));
  EXPECT_EQ(al(), "08 00 00 00 00 00");
}

TEST_F(EscWatchdogTest, InputsAloneDoNotKeepTheWatchdog) {
  start_op();
  for (int i = 0; i < 30; ++i) {
    run(kCycle);
    EXPECT_EQ(datagram(kLrd, 0x0001'0013, Bytes(29, 0)).counter, 1);
  }
  EXPECT_EQ(al(), "14 00 00 00 1B 00");
}

TEST_F(EscWatchdogTest, InSafeOpTheWatchdogIsToldAndNoError) {
  start();
  EXPECT_EQ(show(0x0440, 1), "00");
  EXPECT_EQ(exchange(), 3);
  EXPECT_EQ(show(0x0440, 1), "01");
  run(milliseconds(200));
  EXPECT_EQ(show(0x0440, 3), "00 00 01");
  EXPECT_EQ(al(), "04 00 00 00 00 00");
  EXPECT_EQ(slave().model().power_state(), drive::DriveState::switch_on_disabled);
}

TEST_F(EscWatchdogTest, ADriveWithPowerTakesTheEndOfOpForTheLossOfItsMaster) {
  start();
  preset();
  EXPECT_EQ(exchange(), 3);
  ASSERT_EQ(request(8), "08 00 00 00 00 00");
  enable();
  EXPECT_EQ(request(4), "04 00 00 00 00 00");
  run(milliseconds(50));
  EXPECT_EQ(slave().model().power_state(), drive::DriveState::fault);
}

TEST_F(EscWatchdogTest, SilenceIsTheLossOfTheMasterWithoutPowerToo) {
  start_op();
  run(milliseconds(200));
  EXPECT_EQ(slave().model().power_state(), drive::DriveState::fault);
  EXPECT_EQ(fetch_data().substr(0, 11), "00 10 00 75");
}

TEST_F(EscWatchdogTest, AFamilyThatHasPowerInOpAloneLosesItAtOnce) {
  load();
  profile_->rules.nmt.disables_outside_operational = true;
  profile_->faults.clear();
  start();
  preset();
  EXPECT_EQ(exchange(), 3);
  ASSERT_EQ(request(8), "08 00 00 00 00 00");
  enable();
  EXPECT_EQ(request(4), "04 00 00 00 00 00");
  EXPECT_EQ(slave().model().power_state(), drive::DriveState::switch_on_disabled);
  EXPECT_EQ(fetch(), "");
  EXPECT_EQ(exchange(), 3);
  ASSERT_EQ(request(8), "08 00 00 00 00 00");
  run(milliseconds(200));
  EXPECT_EQ(fetch_data().substr(0, 11), "00 10 30 81");  // No alarm of the family stands for it.
}

TEST_F(EscWatchdogTest, OneWithoutPowerLeavesOpInPeace) {
  start_op();
  EXPECT_EQ(request(4), "04 00 00 00 00 00");
  EXPECT_EQ(request(2), "02 00 00 00 00 00");
  run(milliseconds(500));
  EXPECT_EQ(slave().model().power_state(), drive::DriveState::switch_on_disabled);
  EXPECT_EQ(fetch(), "");
}

}  // namespace
}  // namespace servoctl::sim
