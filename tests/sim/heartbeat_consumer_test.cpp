#include "sim/heartbeat_consumer.hpp"

#include "canopen/nmt.hpp"
#include "sim_support.hpp"

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;

constexpr TimePoint kStart{1s};
const auto kBeat = canopen::heartbeat_frame(127, canopen::NmtState::operational);

TEST(HeartbeatConsumer, WatchesFromTheFirstHeartbeatOn) {
  HeartbeatConsumer consumer;
  consumer.set(1, 0x007F'01F4);
  EXPECT_EQ(consumer.deadline(), kNever);
  EXPECT_FALSE(consumer.take_lost(kStart + 1h));
  consumer.on_frame(kBeat, kStart);
  EXPECT_EQ(consumer.deadline(), kStart + 500ms);
  EXPECT_FALSE(consumer.take_lost(kStart + 499ms));
  EXPECT_TRUE(consumer.take_lost(kStart + 500ms));
  EXPECT_FALSE(consumer.take_lost(kStart + 501ms));
}

TEST(HeartbeatConsumer, EveryHeartbeatGivesItTheWholeTimeAnew) {
  HeartbeatConsumer consumer;
  consumer.set(2, 0x007F'01F4);
  consumer.on_frame(kBeat, kStart);
  consumer.on_frame(kBeat, kStart + 400ms);
  EXPECT_FALSE(consumer.take_lost(kStart + 899ms));
  EXPECT_TRUE(consumer.take_lost(kStart + 900ms));
}

TEST(HeartbeatConsumer, HearsNoOtherNodeAndNothingWhenItIsOff) {
  HeartbeatConsumer consumer;
  consumer.set(1, 0x007F'01F4);
  consumer.on_frame(canopen::heartbeat_frame(126, canopen::NmtState::operational), kStart);
  EXPECT_EQ(consumer.deadline(), kNever);
  consumer.on_frame(kBeat, kStart);
  consumer.set(1, 0);
  EXPECT_EQ(consumer.deadline(), kNever);
  consumer.set(1, 0x007F'0000);
  consumer.on_frame(kBeat, kStart);
  EXPECT_EQ(consumer.deadline(), kNever);
}

class LostMaster : public CellTest {
 protected:
  /// Enabled and watching node 127; then nobody sends any more.
  void enable_and_fall_silent(const std::string& family) {
    build(family + "@1");
    ASSERT_EQ(next(100ms), "701#00");
    EXPECT_EQ(ask("601#23161001F4017F00").substr(0, 6), "581#60");
    for (const char* word : {"06", "07", "0F"}) (void)ask(std::string("601#2B406000") + word + "000000");
    EXPECT_EQ(drive().power_state(), drive::DriveState::operation_enabled);
    ASSERT_TRUE(bus.send(kBeat));
  }
};

TEST_F(LostMaster, IsAFaultWhereNothingElseIsSet) {
  enable_and_fall_silent("gsd600");
  EXPECT_EQ(next(499ms), "");
  EXPECT_EQ(drive().power_state(), drive::DriveState::operation_enabled);
  EXPECT_EQ(next(50ms), "081#3081110000000000");  // Life guard or heartbeat error (CiA 301, table 26).
  (void)next(50ms);
  EXPECT_EQ(drive().power_state(), drive::DriveState::fault);
}

TEST_F(LostMaster, DoesWhatTheAbortConnectionOptionSays) {
  enable_and_fall_silent("cia402");
  EXPECT_EQ(ask("601#2B07600002000000").substr(0, 6), "581#60");  // 2: disable voltage.
  EXPECT_EQ(next(600ms).substr(0, 8), "081#3081");
  EXPECT_EQ(drive().power_state(), drive::DriveState::switch_on_disabled);
}

TEST_F(LostMaster, DoesNothingWhereTheOptionIsNoAction) {
  enable_and_fall_silent("cia402");
  EXPECT_EQ(next(600ms).substr(0, 8), "081#3081");
  EXPECT_EQ(drive().power_state(), drive::DriveState::operation_enabled);
}

}  // namespace
}  // namespace servoctl::sim
