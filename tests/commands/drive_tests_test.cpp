// `test comm` and `test io`: what makes them fail, and what does not.
#include <gtest/gtest.h>

#include <algorithm>

#include "tested_drive.hpp"
#include "trial/comm_trial.hpp"

namespace servoctl::commands {
using namespace command;
namespace {

using namespace std::chrono_literals;

class DriveTests : public TestedDrive {
 protected:
  void write(ObjectAddress object, Bytes bytes) {
    ASSERT_TRUE(session->download(1, object, std::move(bytes)));
  }
};

TEST_F(DriveTests, CommPassesOnAHealthyDrive) {
  build("gsd600@1", "gsd600");
  const auto result = run("test comm", {{"--count", "50"}});
  EXPECT_EQ(criterion(result, "lost_answers"), "passed 0");
  EXPECT_EQ(criterion(result, "heartbeat"), "skipped null");
  EXPECT_TRUE(context.errors.empty());
}

TEST_F(DriveTests, CommCountsEveryLostAnswerAlthoughReadsAreRepeatedElsewhere) {
  build("gsd600@1", "gsd600");
  drive().wire_faults().drop_answers = 2;
  EXPECT_EQ(criterion(run("test comm"), "lost_answers"), "failed 2");
  EXPECT_TRUE(failed());
  EXPECT_EQ(session->options().retries, 1U) << "the retries are back";
}

TEST_F(DriveTests, CommGivesADeadNodeUpSoon) {
  build("gsd600@1", "gsd600");
  drive().wire_faults().silent = true;
  EXPECT_EQ(criterion(run("test comm", {{"--count", "100000"}}), "lost_answers"), "failed 3");
  EXPECT_LT(seconds(), 5);
}

TEST_F(DriveTests, CommFailsWhenAnAnswerIsTooLate) {
  build("gsd600@1?delay=20ms", "gsd600");
  EXPECT_TRUE(
      criterion(run("test comm", {{"--longest", "10ms"}}), "longest_round_trip").starts_with("failed 20"));
  EXPECT_TRUE(
      criterion(run("test comm", {{"--longest", "50ms"}}), "longest_round_trip").starts_with("passed"));
}

/// A computer that is late for so long in every wait.
trial::CommTrial on_busy_computer(Duration each) {
  trial::CommTrial out{.count = 5, .longest = 10ms};
  out.own_delay = [late = Duration::zero(), each]() mutable { return late += each; };
  return out;
}

TEST_F(DriveTests, CommTakesOffForWhatThisComputerWasLate) {
  build("gsd600@1?delay=20ms", "gsd600");
  const auto judged = trial::test_communication(context, 1, on_busy_computer(15ms));
  ASSERT_TRUE(judged);
  for (const auto& one : judged->criteria)
    if (one.id == "longest_round_trip") {
      EXPECT_EQ(one.verdict, report::Verdict::passed);
      EXPECT_EQ(one.note, "without up to 15 ms for which this computer was busy");
    }
  EXPECT_TRUE(report::passed(*judged));
  const auto on_time = trial::test_communication(context, 1, on_busy_computer(0ms));
  ASSERT_TRUE(on_time);
  EXPECT_FALSE(report::passed(*on_time)) << "the drive itself is late";
}

TEST_F(DriveTests, CommDoesNotCountAsLostWhatThisComputerMissed) {
  build("gsd600@1", "gsd600");
  drive().wire_faults().drop_answers = 2;
  const auto judged = trial::test_communication(context, 1, on_busy_computer(400ms));
  ASSERT_TRUE(judged);
  EXPECT_EQ(judged->criteria.front().verdict, report::Verdict::passed);
  EXPECT_EQ(judged->criteria.front().note, "in 3 reads; 2 more were not judged: this computer was busy");
  drive().wire_faults().silent = true;
  const auto never = trial::test_communication(context, 1, on_busy_computer(400ms));
  ASSERT_TRUE(never);
  EXPECT_EQ(never->criteria.front().verdict, report::Verdict::skipped);
}

TEST_F(DriveTests, CommHoldsTheHeartbeatAgainst1017h) {
  build("gsd600@1", "gsd600");
  write({0x1017, 0}, {100, 0});
  EXPECT_EQ(criterion(run("test comm"), "heartbeat"), "passed 4");
  EXPECT_TRUE(context.errors.empty());
  bool drop = false;
  bus->on_receive = [&](can::Frame& frame) {
    // Every other heartbeat is lost on the way.
    if (frame.id == 0x701 && (drop = !drop)) frame.id = 0x7F0;
  };
  EXPECT_TRUE(criterion(run("test comm"), "heartbeat_period").starts_with("failed 1"));
  bus->on_receive = [](can::Frame& frame) {
    if (frame.id == 0x701) frame.id = 0x7F0;
  };
  EXPECT_EQ(criterion(run("test comm"), "heartbeat"), "failed 0");
}

TEST_F(DriveTests, CommFailsWhenTheDriveHasAnEmergencyOrRestarts) {
  build("gsd600@1", "gsd600");
  drive().raise_fault_at({0xFF00, {}}, session->now() + 5ms);
  EXPECT_EQ(criterion(run("test comm"), "emergencies"), "failed 1");
  EXPECT_FALSE(context.notices.empty()) << "what was heard is told as well";
  bus->on_receive = [sent = false](can::Frame& frame) mutable {
    if (!std::exchange(sent, true)) frame = *can::parse_frame("701#00");
  };
  EXPECT_EQ(criterion(run("test comm", {{"--count", "5"}}), "restarts"), "failed 1");
}

TEST_F(DriveTests, CommDoesNotBlameItselfForWhatWasHeardBefore) {
  build("gsd600@1", "gsd600");
  drive().raise_fault_at({0xFF00, {}}, session->now());
  ASSERT_TRUE(session->wait([] { return false; }, session->now() + 50ms));
  EXPECT_EQ(criterion(run("test comm"), "emergencies"), "passed 0");
}

TEST_F(DriveTests, CommCountsReportsOfTheController) {
  build("gsd600@1", "gsd600");
  bus->on_receive = [sent = false](can::Frame& frame) mutable {
    // Class 004h, data[1] = 08h: more errors than usual when receiving (linux/can/error.h).
    if (!std::exchange(sent, true)) frame = *can::parse_frame("20000004#0004000000000000");
  };
  EXPECT_EQ(criterion(run("test comm", {{"--count", "5"}}), "controller_reports"), "failed 1");
}

/// Puts what is wired to the inputs into the answers of 60FDh.
class InputTests : public DriveTests {
 protected:
  void actuate(std::function<std::uint8_t(double seconds)> levels) {
    build("gsd600@1", "gsd600");
    bus->on_receive = [this, levels = std::move(levels)](can::Frame& frame) {
      if (frame.id == 0x581 && frame.data[1] == 0xFD && frame.data[2] == 0x60)
        frame.data[4] = levels(seconds());
    };
  }
};

TEST_F(InputTests, PassesAndEndsWhenEachWasSeenBothWays) {
  actuate([](double t) { return t > 1 && t < 2 ? 0x02 : t > 3 ? 0x04 : 0x00; });
  const auto result = run("test io", {{"--expect", "positive-limit,home"}, {"--for", "20s"}});
  EXPECT_EQ(criterion(result, "positive-limit"), "passed \"0, 1\"");
  EXPECT_EQ(criterion(result, "home"), "passed \"0, 1\"");
  EXPECT_TRUE(context.errors.empty());
  EXPECT_LT(seconds(), 4);
  EXPECT_EQ(lines.size(), 5U) << "both at first, then each change";
}

TEST_F(InputTests, FailsWhenAnExpectedInputStays) {
  actuate([](double t) { return t > 1 && t < 2 ? 0x02 : 0x00; });
  const auto result = run("test io", {{"--expect", "positive-limit,home"}, {"--for", "5s"}});
  EXPECT_EQ(criterion(result, "home"), "failed \"only 0\"");
  EXPECT_TRUE(failed());
  EXPECT_GE(seconds(), 5);
}

TEST_F(InputTests, WithoutExpectationPassesWhenAnyInputChanged) {
  actuate([](double t) { return t > 1 ? 0x01 : 0x00; });
  EXPECT_EQ(criterion(run("test io", {{"--for", "2s"}}), "inputs_changed"), "passed 1");
  bus->on_receive = {};
  EXPECT_EQ(criterion(run("test io", {{"--for", "2s"}}), "inputs_changed"), "failed 0");
}

TEST_F(InputTests, JudgesWhatWasSeenWhenInterrupted) {
  actuate([](double t) { return t > 1 ? 0x01 : 0x00; });
  session->options().cancelled = [this] { return seconds() > 2; };
  EXPECT_EQ(criterion(run("test io", {{"--for", "1min"}}), "negative-limit"), "passed \"0, 1\"");
}

TEST_F(InputTests, KnowsTheBitsOfTheFamily) {
  build("sv2@1", "sv2");
  bus->on_receive = [this](can::Frame& frame) {
    if (frame.id == 0x581 && frame.data[1] == 0xFD && frame.data[2] == 0x60)
      frame.data[4] = seconds() > 1 ? 0x01 : 0x00;
  };
  EXPECT_EQ(criterion(run("test io", {{"--expect", "home"}, {"--for", "3s"}}), "home"), "passed \"0, 1\"");
}

TEST_F(InputTests, SaysThatADriveDoesNotShowItsInputs) {
  build("dm@1", "dm");
  const auto result = run("test io", {{"--for", "1s"}});
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, Errc::sdo_abort);
  EXPECT_FALSE(result.error().hint.text().empty());
}

}  // namespace
}  // namespace servoctl::commands
