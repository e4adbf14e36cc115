#include "canopen/node_watch.hpp"

#include "transcript.hpp"

namespace servoctl::canopen {
namespace {

using namespace std::chrono_literals;

class NodeWatchTest : public testing::Test {
 protected:
  void hear(std::string_view text, Duration after) {
    now += after;
    watch.on_time(now);
    watch.on_frame(frame(text), now);
  }
  std::vector<std::size_t> kinds() {
    std::vector<std::size_t> out;
    while (const auto event = watch.take_event()) out.push_back(event->what.index());
    return out;
  }
  static constexpr std::size_t kBootUp = 0, kChange = 1, kLost = 2, kEmergency = 3;
  NodeWatch watch;
  TimePoint now{1s};
};

TEST_F(NodeWatchTest, TellsBootUpAndCountsIt) {
  hear("705#00", 1ms);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{kBootUp});
  EXPECT_EQ(watch.boots(5), 1U);
  EXPECT_EQ(watch.state(5), NmtState::pre_operational);
  EXPECT_EQ(watch.state(6), std::nullopt);
}

TEST_F(NodeWatchTest, TellsBootUpsInSuccessionInOneEvent) {
  for (int i = 0; i < 20; ++i) hear("705#00", 100ms);
  const auto event = watch.take_event();
  ASSERT_TRUE(event);
  EXPECT_EQ(event->times, 20U);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{});
  EXPECT_EQ(watch.boots(5), 20U);
  hear("705#00", 1ms);
  hear("706#00", 1ms);
  hear("705#05", 1ms);
  hear("705#00", 1ms);
  EXPECT_EQ(kinds(), (std::vector<std::size_t>{kBootUp, kBootUp, kChange, kBootUp}));
}

TEST_F(NodeWatchTest, TellsAChangeOfStateButNotTheFirstOneHeard) {
  hear("705#7F", 1ms);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{});
  hear("705#05", 100ms);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{kChange});
  hear("705#05", 100ms);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{});
}

TEST_F(NodeWatchTest, TellsTheLossOfARegularHeartbeatOnceAndItsReturn) {
  for (int i = 0; i < 4; ++i) hear("705#05", 200ms);
  EXPECT_EQ(watch.deadline(), now + 600ms);
  watch.on_time(now + 599ms);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{});
  watch.on_time(now + 600ms);
  watch.on_time(now + 5s);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{kLost});
  EXPECT_EQ(watch.deadline(), kNever);
  hear("705#05", 10s);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{kChange});
}

TEST_F(NodeWatchTest, TakesNoExtraMessageAtAChangeForThePeriod) {
  hear("705#7F", 1s);
  hear("705#7F", 1s);
  hear("705#05", 5ms);
  hear("705#05", 995ms);
  hear("705#05", 1s);
  watch.on_time(now + 2900ms);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{kChange});
  watch.on_time(now + 3s);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{kLost});
}

TEST_F(NodeWatchTest, DoesNotMissASingleHeartbeatThatWasNeverRepeated) {
  hear("705#05", 1s);
  hear("705#05", 1s);
  EXPECT_EQ(watch.deadline(), kNever);
}

TEST_F(NodeWatchTest, LearnsAnewAfterBootUp) {
  for (int i = 0; i < 4; ++i) hear("705#05", 100ms);
  hear("705#00", 10ms);
  watch.on_time(now + 1h);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{kBootUp});
}

TEST_F(NodeWatchTest, TellsNoChangeAfterALostNodeHasBooted) {
  for (int i = 0; i < 4; ++i) hear("705#7F", 100ms);
  watch.on_time(now + 1h);
  now += 1h;
  hear("705#00", 1ms);
  hear("705#7F", 100ms);
  EXPECT_EQ(kinds(), (std::vector<std::size_t>{kLost, kBootUp}));
}

TEST_F(NodeWatchTest, DoesNotTakeTheSilenceOfALostNodeForItsPeriod) {
  for (int i = 0; i < 4; ++i) hear("705#05", 200ms);
  watch.on_time(now + 1s);
  for (int i = 0; i < 4; ++i) hear("705#05", i == 0 ? 10s : Duration(200ms));
  EXPECT_EQ(watch.deadline(), now + 600ms);
}

TEST_F(NodeWatchTest, DoesNotKnowTheStateOfASilentNodeAfterACommand) {
  hear("705#00", 1ms);
  hear("706#00", 1ms);
  hear("707#05", 1ms);
  watch.on_command(5);
  EXPECT_EQ(watch.state(5), std::nullopt);
  EXPECT_EQ(watch.state(6), NmtState::pre_operational);
  watch.on_command(0);
  EXPECT_EQ(watch.state(6), std::nullopt);
  EXPECT_EQ(watch.state(7), NmtState::operational) << "its heartbeats tell";
}

TEST_F(NodeWatchTest, RemembersEmergenciesUntilTheyAreReset) {
  for (int i = 0; i < 9; ++i) hear("085#308111000000000" + std::to_string(i), 1ms);
  EXPECT_EQ(watch.emergencies(5).size(), 8U);
  EXPECT_EQ(watch.emergencies(5).front().vendor[4], 1);
  hear("085#0000000000000000", 1ms);
  EXPECT_TRUE(watch.emergencies(5).empty());
  hear("085#3081110000000000", 1ms);
  hear("705#00", 1ms);
  EXPECT_TRUE(watch.emergencies(5).empty());
}

TEST_F(NodeWatchTest, PassesEmergenciesOn) {
  hear("083#00FF810000000000", 1ms);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{kEmergency});
}

TEST_F(NodeWatchTest, KnowsThePeriodAfterTwoIntervals) {
  for (int i = 0; i < 2; ++i) hear("705#05", 50ms);
  EXPECT_EQ(watch.deadline(), kNever);
  hear("705#05", 50ms);
  EXPECT_EQ(watch.period(5), 50ms);
  EXPECT_EQ(watch.deadline(), now + 150ms);
  hear("705#05", 60ms);
  EXPECT_EQ(watch.period(5), 60ms);
  hear("705#05", 50ms);
  EXPECT_EQ(watch.deadline(), now + 180ms);
  EXPECT_EQ(watch.heartbeats(5), 5U);
}

TEST_F(NodeWatchTest, WaitsAHundredMillisecondsMoreThanAShortPeriod) {
  for (int i = 0; i < 3; ++i) hear("705#05", 10ms);
  EXPECT_EQ(watch.deadline(), now + 110ms);
  watch.on_time(now + 109ms);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{});
  watch.on_time(now + 110ms);
  const auto event = watch.take_event();
  ASSERT_TRUE(event);
  EXPECT_EQ(event->node, 5);
  EXPECT_EQ(event->time, now + 110ms);
  EXPECT_EQ(std::get<NodeEvent::HeartbeatLost>(event->what).silence, 110ms);
}

TEST_F(NodeWatchTest, MeasuresThePeriodAnewAfterABootUp) {
  for (int i = 0; i < 4; ++i) hear("705#05", 1s);
  hear("705#00", 500ms);
  EXPECT_EQ(watch.deadline(), kNever);
  for (int i = 0; i < 2; ++i) hear("705#7F", 100ms);
  EXPECT_EQ(watch.deadline(), kNever);
  hear("705#7F", 100ms);
  EXPECT_EQ(watch.deadline(), now + 300ms);
  EXPECT_EQ(watch.boots(5), 1U);
}

TEST_F(NodeWatchTest, MeasuresThePeriodAnewAfterALoss) {
  for (int i = 0; i < 4; ++i) hear("705#05", 200ms);
  watch.on_time(now + 600ms);
  EXPECT_EQ(watch.deadline(), kNever);
  now += 1s;
  for (int i = 0; i < 2; ++i) hear("705#05", 100ms);
  EXPECT_EQ(watch.deadline(), kNever);
  hear("705#05", 100ms);
  EXPECT_EQ(watch.deadline(), now + 300ms);
  EXPECT_EQ(kinds(), (std::vector<std::size_t>{kLost, kChange}));
}

TEST_F(NodeWatchTest, DoesNotMissAGuardedNode) {
  for (int i = 0; i < 4; ++i) hear("705#05", 100ms);
  watch.set_guarded(5, true);
  EXPECT_EQ(watch.deadline(), kNever);
  watch.on_time(now + 1h);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{});
  watch.set_guarded(5, false);
  EXPECT_EQ(watch.deadline(), now + 300ms);
}

/// A node that was asked now and then promises nothing.
TEST_F(NodeWatchTest, DoesNotTakeAnswersToItsOwnQuestionsForHeartbeats) {
  for (int i = 0; i < 5; ++i) {
    watch.on_sent(frame("705#R1"), TimePoint());
    hear("705#04", 100ms);
  }
  EXPECT_EQ(watch.deadline(), kNever);
  EXPECT_EQ(watch.state(5), NmtState::stopped);
  for (int i = 0; i < 4; ++i) hear("706#05", 100ms);
  watch.on_sent(frame("705#R1"), TimePoint());
  EXPECT_EQ(watch.deadline(), now + 300ms) << "that of node 6";
}

TEST_F(NodeWatchTest, ForgetsWhatItHasLearned) {
  for (int i = 0; i < 4; ++i) hear("705#05", 100ms);
  hear("705#00", 1ms);
  for (int i = 0; i < 4; ++i) hear("705#05", 100ms);
  watch.set_guarded(6, true);
  watch.forget(5);
  watch.forget(6);
  EXPECT_EQ(watch.deadline(), kNever);
  EXPECT_EQ(watch.state(5), std::nullopt);
  EXPECT_EQ(watch.boots(5), 1U);
  EXPECT_EQ(watch.heartbeats(5), 0U);
  for (int i = 0; i < 4; ++i) hear("706#05", 100ms);
  EXPECT_EQ(watch.deadline(), kNever);
}

TEST_F(NodeWatchTest, MissesEveryNodeInItsOwnTime) {
  for (int i = 0; i < 4; ++i) {
    hear("701#05", 50ms);
    hear("77F#05", 50ms);
  }
  EXPECT_EQ(watch.deadline(), now + 250ms);
  watch.on_time(now + 250ms);
  EXPECT_EQ(watch.deadline(), now + 300ms);
  watch.on_time(now + 300ms);
  EXPECT_EQ(watch.deadline(), kNever);
  EXPECT_EQ(watch.take_event()->node, 1);
  EXPECT_EQ(watch.take_event()->node, 127);
  EXPECT_FALSE(watch.take_event());
}

/// A node that is told to send half as often has not fallen silent.
TEST_F(NodeWatchTest, LearnsThePeriodAnewWhenSomebodyWrites1017h) {
  for (int i = 0; i < 4; ++i) hear("705#05", 20ms);
  for (int i = 0; i < 4; ++i) hear("706#05", 20ms);
  watch.on_sent(frame("605#2B171000F4010000"), TimePoint());
  EXPECT_EQ(watch.period(5), 0ms);
  EXPECT_EQ(watch.deadline(), now + 120ms) << "that of node 6";
  hear("606#2B171000F4010000", 0ms);
  EXPECT_EQ(watch.deadline(), kNever);
  for (int i = 0; i < 3; ++i) hear("705#05", 500ms);
  EXPECT_TRUE(kinds().empty());
  EXPECT_EQ(watch.deadline(), now + 1500ms);
  for (const auto* other : {"605#4017100000000000", "605#2B161000F4010000", "585#2B171000F4010000"})
    hear(other, 0ms);
  EXPECT_EQ(watch.deadline(), now + 1500ms);
}

/// Every second one has no toggle bit, and looks as a heartbeat does.
TEST_F(NodeWatchTest, TakesAnswersToTheGuardingOfAnotherMasterForNoHeartbeats) {
  for (int i = 0; i < 6; ++i) {
    hear("705#R1", 200ms);
    hear(i % 2 == 0 ? "705#7F" : "705#FF", 1ms);
  }
  EXPECT_EQ(watch.deadline(), kNever);
  watch.on_time(now + 10s);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{});
  EXPECT_EQ(watch.state(5), NmtState::pre_operational);
  for (int i = 0; i < 3; ++i) hear("705#7F", 100ms);
  watch.on_time(now + 1s);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{kLost}) << "heartbeats that begin afterwards";
}

TEST_F(NodeWatchTest, CountsAnEmergencyThatANodeRepeats) {
  for (const auto* text : {"083#00FF810000000000", "084#00FF810000000000", "083#00FF810000000000",
                           "083#00FF810000000000", "083#00FF810000000001", "083#00FF810000000000"})
    hear(text, 1ms);
  std::string times;
  while (const auto event = watch.take_event())
    times += std::to_string(event->node) + "x" + std::to_string(event->times) + " ";
  EXPECT_EQ(times, "3x3 4x1 3x1 3x1 ");
  hear("083#00FF810000000000", 1ms);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{kEmergency});
}

}  // namespace
}  // namespace servoctl::canopen
