#include "canopen/node_guard.hpp"

#include "canopen/error_control.hpp"
#include "transcript.hpp"

namespace servoctl::canopen {
namespace {

using namespace std::chrono_literals;

class NodeGuardTest : public testing::Test {
 protected:
  void start(std::uint8_t node = 2) {
    guard.start(node, {100ms, 3}, now);
    guard.on_time(now);
  }
  template <class What>
  const What* event() {
    last = guard.take_event();
    return last ? std::get_if<What>(&last->what) : nullptr;
  }
  NodeGuard guard;
  TimePoint now{1s};
  std::optional<NodeEvent> last;
};

TEST_F(NodeGuardTest, AsksByRemoteFramesAndChecksThatTheToggleBitAlternates) {
  start();
  play(guard, now,
       {"> 702#R1", "< 702#7F", "+ 99ms", "> 702#R1", "< 702#FF", "+ 99ms", "> 702#R1", "< 702#05", "+ 99ms",
        "> 702#R1", "< 702#85"});
  EXPECT_FALSE(guard.take_event());
}

TEST_F(NodeGuardTest, TellsALostNodeOnceAfterItsLifeTimeAndWhenItIsBack) {
  start();
  play(
      guard, now,
      {"> 702#R1", "< 702#7F", "+ 99ms", "> 702#R1", "+ 100ms", "> 702#R1", "+ 100ms", "> 702#R1", "+ 99ms"});
  EXPECT_FALSE(guard.take_event());
  play(guard, now, {"+ 1ms", "> 702#R1", "+ 100ms", "> 702#R1"});
  const auto* lost = event<NodeEvent::GuardingLost>();
  ASSERT_NE(lost, nullptr);
  EXPECT_EQ(last->node, 2);
  EXPECT_EQ(lost->silence, 300ms);
  EXPECT_FALSE(lost->wrong_toggle);
  EXPECT_FALSE(guard.take_event());
  play(guard, now, {"< 702#85"});
  const auto* back = event<NodeEvent::GuardingBack>();
  ASSERT_NE(back, nullptr);
  EXPECT_EQ(back->state, NmtState::operational);
}

TEST_F(NodeGuardTest, TakesAnAnswerThatDoesNotToggleAsNone) {
  start();
  play(guard, now, {"> 702#R1", "< 702#7F"});
  for (int i = 0; i < 3; ++i) play(guard, now, {"+ 99ms", "> 702#R1", "< 702#7F"});
  EXPECT_FALSE(guard.take_event());
  play(guard, now, {"+ 99ms", "> 702#R1"});
  const auto* lost = event<NodeEvent::GuardingLost>();
  ASSERT_NE(lost, nullptr);
  EXPECT_TRUE(lost->wrong_toggle);
}

TEST_F(NodeGuardTest, TakesEitherToggleBitAfterABootUp) {
  start();
  play(guard, now,
       {"> 702#R1", "< 702#7F", "< 702#00", "+ 98ms", "> 702#R1", "< 702#7F", "+ 99ms", "> 702#R1",
        "< 702#FF"});
  EXPECT_FALSE(guard.take_event());
  play(guard, now, {"+ 99ms", "> 702#R1", "+ 100ms", "> 702#R1", "+ 100ms", "> 702#R1"});
  EXPECT_FALSE(guard.take_event());
}

TEST_F(NodeGuardTest, GuardsManyNodesEachForItself) {
  start(2);
  start(3);
  play(guard, now,
       {"> 702#R1", "> 703#R1", "< 702#7F", "+ 99ms", "> 702#R1", "> 703#R1", "< 702#FF", "+ 99ms",
        "> 702#R1", "> 703#R1", "< 702#7F", "+ 99ms", "> 702#R1", "> 703#R1", "< 702#FF"});
  ASSERT_NE(event<NodeEvent::GuardingLost>(), nullptr);
  EXPECT_EQ(last->node, 3);
  EXPECT_FALSE(guard.take_event());
  guard.stop(2);
  guard.stop(3);
  EXPECT_EQ(guard.deadline(), kNever);
}

TEST_F(NodeGuardTest, IgnoresRemoteFramesAndNodesItDoesNotGuard) {
  start();
  play(guard, now, {"> 702#R1", "< 702#R1", "< 703#7F", "< 00000702#7F", "+ 300ms", "> 702#R1"});
  EXPECT_NE(event<NodeEvent::GuardingLost>(), nullptr);
}

TEST_F(NodeGuardTest, NeverLosesANodeWhoseToggleBitAlternates) {
  for (const bool begins_high : {false, true}) {
    start();
    play(guard, now, {"> 702#R1"});
    bool high = begins_high;
    for (int i = 0; i < 20; ++i, high = !high)
      play(guard, now, {high ? "< 702#FF" : "< 702#7F", "+ 99ms", "> 702#R1"});
    EXPECT_FALSE(guard.take_event());
  }
}

TEST_F(NodeGuardTest, TakesTheSameToggleBitAgainAfterABootUp) {
  start();
  play(guard, now,
       {"> 702#R1", "< 702#7F", "< 702#00", "+ 98ms", "> 702#R1", "< 702#7F", "+ 99ms", "> 702#R1"});
  EXPECT_EQ(guard.deadline(), now + 100ms);
  play(guard, now, {"+ 100ms", "> 702#R1", "+ 100ms", "> 702#R1", "+ 99ms"});
  EXPECT_FALSE(guard.take_event());
  play(guard, now, {"+ 1ms", "> 702#R1"});
  EXPECT_NE(event<NodeEvent::GuardingLost>(), nullptr);
}

TEST_F(NodeGuardTest, ForgetsAWrongToggleBitWithTheNextGoodAnswer) {
  start();
  play(guard, now, {"> 702#R1", "< 702#7F", "+ 99ms", "> 702#R1", "< 702#7F", "< 702#FF"});
  play(guard, now,
       {"+ 98ms", "> 702#R1", "+ 100ms", "> 702#R1", "+ 100ms", "> 702#R1", "+ 100ms", "> 702#R1"});
  const auto* lost = event<NodeEvent::GuardingLost>();
  ASSERT_NE(lost, nullptr);
  EXPECT_FALSE(lost->wrong_toggle);
}

TEST_F(NodeGuardTest, TakesEitherToggleBitOfANodeThatWasLost) {
  start();
  play(guard, now, {"> 702#R1", "< 702#7F"});
  now += 99ms;
  for (int i = 0; i < 4; ++i, now += 100ms) {
    guard.on_time(now);
    EXPECT_EQ(guard.deadline(), now + 100ms);
    play(guard, now, {"> 702#R1"});
  }
  ASSERT_NE(event<NodeEvent::GuardingLost>(), nullptr);
  play(guard, now, {"< 702#7F"});
  EXPECT_NE(event<NodeEvent::GuardingBack>(), nullptr);
}

TEST_F(NodeGuardTest, AsksAPeriodAfterItHasAskedLate) {
  start();
  play(guard, now, {"> 702#R1", "+ 130ms", "> 702#R1", "+ 100ms", "> 702#R1"});
  EXPECT_EQ(guard.deadline(), now + 70ms);
  play(guard, now, {"< 702#7F"});
  EXPECT_EQ(guard.deadline(), now + 99ms);
}

TEST_F(NodeGuardTest, BeginsAnewWhenItIsStartedAgain) {
  start();
  play(guard, now, {"> 702#R1", "+ 100ms", "> 702#R1", "+ 100ms", "> 702#R1"});
  start();
  play(guard, now, {"> 702#R1", "+ 100ms", "> 702#R1", "+ 100ms", "> 702#R1", "+ 99ms"});
  EXPECT_FALSE(guard.take_event());
  play(guard, now, {"+ 1ms", "> 702#R1"});
  EXPECT_NE(event<NodeEvent::GuardingLost>(), nullptr);
  EXPECT_TRUE(guard.guards(2));
  guard.stop(2);
  EXPECT_FALSE(guard.guards(2));
  play(guard, now, {"+ 1s", "< 702#7F"});
}

class ErrorControlTest : public testing::Test {
 protected:
  void boot() {
    slave.boot(NmtState::pre_operational, now);
    play(slave, now, {"> 702#00"});
  }
  ErrorControlSlave slave{2};
  TimePoint now{1s};
};

TEST_F(ErrorControlTest, AnswersGuardingWithAToggleBitThatBeginsAtZero) {
  boot();
  play(slave, now, {"< 702#R1", "> 702#7F", "< 702#R1", "> 702#FF", "< 702#R", "> 702#7F"});
  slave.set_state(NmtState::operational);
  play(slave, now, {"< 702#R1", "> 702#85", "< 703#R1"});
  boot();
  play(slave, now, {"< 702#R1", "> 702#7F"});
}

TEST_F(ErrorControlTest, SendsHeartbeatsAndAnswersNoGuardingThen) {
  boot();
  slave.set_heartbeat(200ms, now);
  play(slave, now, {"+ 199ms", "+ 1ms", "> 702#7F", "< 702#R1", "+ 198ms", "+ 1ms", "> 702#7F"});
  slave.set_heartbeat(Duration::zero(), now);
  play(slave, now, {"+ 1s", "< 702#R1", "> 702#7F"});
}

TEST_F(ErrorControlTest, NoticesThatTheMasterHasStoppedAsking) {
  boot();
  slave.set_life_time(100ms, 3);
  play(slave, now, {"+ 10s"});
  EXPECT_FALSE(slave.take_life_lost()) << "it begins with the first request";
  play(slave, now, {"< 702#R1", "> 702#7F", "+ 299ms", "< 702#R1", "> 702#FF", "+ 299ms"});
  EXPECT_FALSE(slave.take_life_lost());
  play(slave, now, {"+ 1ms"});
  EXPECT_TRUE(slave.take_life_lost());
  EXPECT_FALSE(slave.take_life_lost());
}

TEST_F(ErrorControlTest, IsSilentUntilItHasBooted) {
  play(slave, now, {"< 702#R1", "+ 1s"});
  boot();
  slave.set_heartbeat(100ms, now);
  slave.stop();
  play(slave, now, {"< 702#R1", "+ 1s"});
}

}  // namespace
}  // namespace servoctl::canopen
