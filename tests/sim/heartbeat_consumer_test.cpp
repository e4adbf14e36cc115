#include "sim/heartbeat_consumer.hpp"

#include <cstdio>

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

class EndedWatch : public DrivenTest, public testing::WithParamInterface<const char*> {};

TEST_P(EndedWatch, LosesNobodyDuringAResetNorBehindIt) {
  boot(GetParam());
  for (const char* reset : {"000#8201", "000#8101"}) {
    ASSERT_EQ(sdo("601#2316100196007F00").substr(0, 6), "581#60");
    ASSERT_TRUE(bus.send(kBeat));
    ASSERT_EQ(next(140ms), "");
    send(reset);
    EXPECT_EQ(next(100ms), "701#00");
    EXPECT_EQ(next(1s), "") << "1016h is 0";
    EXPECT_NE(drive().power_state(), drive::DriveState::fault);
  }
}

INSTANTIATE_TEST_SUITE_P(Families, EndedWatch, testing::Values("gsd600", "dm", "ts", "cia402"),
                         [](const auto& test) { return std::string(test.param); });

struct Behaviour {
  const char* family;
  int value;  ///< Of 1029h:01; -1: the family has none.
  canopen::NmtState after;
};

/// CiA 301, 7.5.2.32: from Operational to Pre-operational (0), no change (1), to Stopped (2).
class ErrorBehaviour : public DrivenTest, public testing::WithParamInterface<Behaviour> {
 protected:
  /// Operational, watching node 127 for 500 ms, which then falls silent.
  void lose_the_master(const char* family, int value) {
    boot(family);
    if (value >= 0) {
      char frame[32];
      std::snprintf(frame, sizeof frame, "601#2F291001%02X000000", static_cast<unsigned>(value));
      ASSERT_EQ(sdo(frame).substr(0, 6), "581#60");
    }
    ASSERT_EQ(sdo("601#23161001F4017F00").substr(0, 6), "581#60");
    send("000#0101");
    send("77F#05");
    wait(600ms);
  }
};

TEST_P(ErrorBehaviour, DecidesTheStateBehindALostHeartbeat) {
  lose_the_master(GetParam().family, GetParam().value);
  EXPECT_EQ(emergency_.substr(0, 8), "081#3081") << "told before the state changes";
  EXPECT_EQ(drive().nmt_state(), GetParam().after);
  const bool silent = GetParam().after == canopen::NmtState::stopped;
  EXPECT_EQ(sdo("601#4000100000000000").empty(), silent) << "no SDO where it is stopped";
}

using canopen::NmtState;
INSTANTIATE_TEST_SUITE_P(
    Families, ErrorBehaviour,
    testing::Values(Behaviour{"gsd600", 0, NmtState::pre_operational},
                    Behaviour{"gsd600", 1, NmtState::operational}, Behaviour{"gsd600", 2, NmtState::stopped},
                    Behaviour{"dm", 0, NmtState::pre_operational}, Behaviour{"dm", 1, NmtState::operational},
                    Behaviour{"dm", 2, NmtState::stopped}, Behaviour{"cia402", 0, NmtState::pre_operational},
                    Behaviour{"cia402", 1, NmtState::operational}, Behaviour{"cia402", 2, NmtState::stopped},
                    Behaviour{"ts", -1, NmtState::pre_operational}),
    [](const auto& test) {
      return std::string(test.param.family) + (test.param.value < 0 ? "" : std::to_string(test.param.value));
    });

TEST_F(ErrorBehaviour, OfTheFactoryLeavesADmAsItIs) {  // 569
  lose_the_master("dm", -1);
  EXPECT_EQ(drive().nmt_state(), NmtState::operational);
}

TEST_F(ErrorBehaviour, OfTheFactoryTakesAGsd600OutOfOperational) {  // 898
  lose_the_master("gsd600", -1);
  EXPECT_EQ(drive().nmt_state(), NmtState::pre_operational);
}

TEST_F(ErrorBehaviour, HoldsForLifeGuardingToo) {
  boot("cia402");
  for (const char* request : {"601#2B0C100064000000", "601#2F0D100002000000"})
    ASSERT_EQ(sdo(request).substr(0, 6), "581#60");
  send("000#0101");
  send("701#R1");
  wait(300ms);
  EXPECT_EQ(emergency_.substr(0, 8), "081#3081");
  EXPECT_EQ(drive().nmt_state(), NmtState::pre_operational);
}

}  // namespace
}  // namespace servoctl::sim
