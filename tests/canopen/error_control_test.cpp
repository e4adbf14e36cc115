#include "canopen/error_control.hpp"

#include "transcript.hpp"

namespace servoctl::canopen {
namespace {

using namespace std::chrono_literals;

class SlaveTest : public testing::Test {
 protected:
  /// All further steps, each of which must send what stands behind it and nothing else.
  void steps(std::initializer_list<std::initializer_list<std::string_view>> all) {
    for (const auto& lines : all) play(slave, now, lines);
  }
  void boot(NmtState state) {
    slave.boot(state, now);
    play(slave, now, {"> 702#00"});
  }
  ErrorControlSlave slave{2};
  TimePoint now{1s};
};

TEST_F(SlaveTest, BeginsItsToggleBitAnewWithEveryBoot) {
  for (int times = 0; times < 2; ++times) {
    boot(NmtState::stopped);
    steps({{"< 702#R1", "> 702#04"}, {"< 702#R1", "> 702#84"}, {"< 702#R1", "> 702#04"}});
  }
}

TEST_F(SlaveTest, KeepsItsHeartbeatOverABoot) {
  slave.set_heartbeat(100ms, now);
  EXPECT_EQ(slave.deadline(), kNever);
  boot(NmtState::operational);
  EXPECT_EQ(slave.deadline(), now + 100ms);
  steps({{"+ 99ms"}, {"+ 1ms", "> 702#05"}, {"+ 99ms"}, {"+ 1ms", "> 702#05"}});
  slave.set_heartbeat(30ms, now);
  steps({{"+ 29ms"}, {"+ 1ms", "> 702#05"}});
}

TEST_F(SlaveTest, SaysNothingBetweenStopAndBoot) {
  boot(NmtState::operational);
  slave.set_life_time(100ms, 2);
  steps({{"< 702#R1", "> 702#05"}});
  slave.stop();
  EXPECT_EQ(slave.deadline(), kNever);
  steps({{"< 702#R1"}, {"+ 1s"}});
  EXPECT_FALSE(slave.take_life_lost());
}

TEST_F(SlaveTest, ForgetsAtBootThatItWasGuarded) {
  slave.set_life_time(100ms, 2);
  for (const bool is_lost : {false, true}) {
    boot(NmtState::operational);
    steps({{"< 702#R1", "> 702#05"}});
    EXPECT_EQ(slave.deadline(), now + 200ms);
    if (is_lost) steps({{"+ 200ms"}});
    boot(NmtState::operational);
    EXPECT_EQ(slave.deadline(), kNever);
    steps({{"+ 1s"}});
    EXPECT_FALSE(slave.take_life_lost());
  }
}

TEST_F(SlaveTest, LosesItsMasterOnlyOnce) {
  boot(NmtState::operational);
  slave.set_life_time(100ms, 2);
  steps({{"< 702#R1", "> 702#05"}, {"+ 200ms"}});
  EXPECT_TRUE(slave.take_life_lost());
  EXPECT_EQ(slave.deadline(), kNever);
  steps({{"+ 1s"}});
  EXPECT_FALSE(slave.take_life_lost());
}

TEST_F(SlaveTest, IsNoLongerGuardedWithALifeTimeOfZero) {
  boot(NmtState::operational);
  slave.set_life_time(100ms, 2);
  steps({{"< 702#R1", "> 702#05"}});
  slave.set_life_time(100ms, 3);
  EXPECT_EQ(slave.deadline(), now + 200ms);
  slave.set_life_time(100ms, 0);
  EXPECT_EQ(slave.deadline(), kNever);
  steps({{"< 702#R1", "> 702#85"}});
  EXPECT_EQ(slave.deadline(), kNever);
}

TEST_F(SlaveTest, AnswersRemoteFramesOfItsOwnOnly) {
  boot(NmtState::operational);
  steps({{"< 702#05"}, {"< 703#R1"}, {"< 00000702#R1"}});
  auto error = frame("702#R1");
  error.error = true;
  slave.on_frame(error, now);
  EXPECT_FALSE(slave.take_frame());
}

}  // namespace
}  // namespace servoctl::canopen
