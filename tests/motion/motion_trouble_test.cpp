// Mechanics that do not do what they are told, and what stands behind the guard.
#include <algorithm>
#include <stdexcept>

#include "motion_support.hpp"
#include "session/can_network.hpp"

namespace servoctl::motion {
namespace {

using namespace std::chrono_literals;
using drive::DriveState;

TEST_F(MotionTrouble, AMotorThatTurnsTheWrongWayIsStoppedAtOnce) {
  bench.drive().axis_faults().reversed = true;
  const auto done = bench.jog(kJog);
  expect_stopped(done, "wrong way");
  EXPECT_LT(done.samples.back().time - done.samples.front().time, 300ms);
}

TEST_F(MotionTrouble, AMotorThatDoesNotTurnIsGivenUp) {
  MotionBench own("ts", 10000);  // Its window for the following error is 0: no fault by itself.
  own.drive().axis_faults().stalled = true;
  const auto done = own.jog(kJog);
  ASSERT_FALSE(done.outcome);
  EXPECT_NE(done.outcome.error().message.text().find("does not turn"), std::string::npos);
  EXPECT_FALSE(own.energised());
  EXPECT_EQ(own.changed(), std::vector<std::string>{});
}

TEST_F(MotionTrouble, AMoveAwayFromItsTargetIsStoppedAtOnce) {
  MotionBench own("ts", 10000);  // Its window for the following error is 0: no fault by itself.
  own.drive().axis_faults().reversed = true;
  const auto done = own.move(move_to("5rev", "250rpm"));
  ASSERT_FALSE(done.outcome);
  EXPECT_NE(done.outcome.error().message.text().find("goes the wrong way"), std::string::npos)
      << done.outcome.error().message.text();
  ASSERT_FALSE(done.samples.empty());
  EXPECT_LT(done.samples.back().time - done.samples.front().time, 1s);
  EXPECT_FALSE(own.energised());
  EXPECT_EQ(own.changed(), std::vector<std::string>{});
}

TEST_F(MotionTrouble, AStallOnTheWayToATargetIsAFollowingError) {
  bench.drive().axis_faults().stalled = true;
  const auto done = bench.move(move_to("5rev", "250rpm"));
  ASSERT_FALSE(done.outcome);
  EXPECT_NE(done.outcome.error().message.text().find("0x8611"), std::string::npos)
      << done.outcome.error().message.text();
  EXPECT_EQ(done.end.state, DriveState::fault);
  EXPECT_FALSE(bench.energised());
}

TEST_F(MotionTrouble, AMoveThatNeverArrivesEndsInTheTimeItNeeds) {
  bench.drive().axis_faults().stalled = true;
  const auto done = bench.move(move_to("90deg", "30rpm"));
  expect_stopped(done, "did not reach");
  EXPECT_LT(done.samples.back().time - done.samples.front().time, 6s);
}

TEST_F(MotionTrouble, AFollowingErrorAboveItsLimitStopsTheMotion) {
  MotionBench own("dm");
  own.options.max_following_error = "0.1deg";
  own.drive().axis_faults().lag = 0.05;
  const auto done = own.jog(kJog);
  ASSERT_FALSE(done.outcome);
  EXPECT_NE(done.outcome.error().message.text().find("following error"), std::string::npos);
  EXPECT_FALSE(own.energised());
}

TEST_F(MotionTrouble, LeavingTheWindowStopsTheMotion) {
  bench.options.window = "90deg";
  const auto done = bench.jog(kJog);
  expect_stopped(done, "the way");
  EXPECT_LT(done.samples.back()[Signal::position].value_or(1e9), 110);
}

TEST_F(MotionTrouble, AMissingIndexPulseEndsHomingInItsTime) {
  bench.obey_switches();
  bench.drive().track().no_index = true;
  const auto done = bench.home(home_by("1", 3s));
  expect_stopped(done, "no home found");
}

TEST_F(MotionTrouble, AStuckSwitchEndsHomingWithItsError) {
  bench.obey_switches();
  bench.drive().track().negative_limit.stuck = true;
  expect_stopped(bench.home(home_by("1")), "with an error");
  // The error bit of that run does not end the next one before it begins.
  bench.drive().track().negative_limit.stuck.reset();
  const auto again = bench.home(home_by("1"));
  EXPECT_TRUE(again.outcome) << again.outcome.error().message.text();
}

TEST_F(MotionTrouble, HomedFromAnEarlierRunIsNotBelievedWhileTheDriveTakesItsTimeToBegin) {
  bench.obey_switches();
  ASSERT_TRUE(bench.home(home_by("1")).outcome);
  bench.drive().axis_faults().late_start = 100ms;
  const auto done = bench.home(home_by("1"));
  ASSERT_TRUE(done.outcome) << done.outcome.error().message.text();
  EXPECT_GE(done.samples.back().time - done.samples.front().time, 390ms);
}

TEST_F(MotionTrouble, ADriveThatNeverBeginsToLookForHomeIsGivenUp) {
  bench.obey_switches();
  ASSERT_TRUE(bench.home(home_by("1")).outcome);
  bench.drive().axis_faults().late_start = 1h;
  expect_stopped(bench.home(home_by("1")), "from an earlier run");
}

TEST_F(MotionTrouble, AValueTheDriveWouldRefuseIsNotPutBackButTold) {
  MotionBench own("da200", 10000);  // Starts with method 0, which is none; a refused write is a fault there.
  const auto done = own.home(home_by("1"));
  ASSERT_TRUE(done.outcome) << done.outcome.error().message.text();
  EXPECT_EQ(own.drive().power_state(), DriveState::switch_on_disabled);
  ASSERT_EQ(done.end.notes.size(), 1U);
  EXPECT_EQ(done.end.notes[0], "object 0x6098:0 keeps its new value: its old value, 00, is out of its range");
}

TEST_F(MotionTrouble, AMethodThatMeansNoHomingIsRefused) {
  MotionBench own("ts", 10000);
  const auto done = own.home(home_by("35"));
  ASSERT_FALSE(done.outcome);
  EXPECT_EQ(done.outcome.error().code, Errc::refused);
}

TEST_F(MotionTrouble, ANodeThatRestartsWhileItMovesIsNotCommandedOn) {
  int samples = 0;
  bench.options.on_sample = [&](const MotionSample&) {
    if (++samples == 20)
      (void)bench.session->can()->send(canopen::nmt_frame(canopen::NmtCommand::reset_node, 1));
  };
  const auto done = bench.jog(kJog);
  ASSERT_FALSE(done.outcome);
  EXPECT_FALSE(bench.energised());
  const auto first_reset =
      std::find(bench.bus->frames.begin(), bench.bus->frames.end(), std::string("000#8101"));
  ASSERT_NE(first_reset, bench.bus->frames.end());
  EXPECT_EQ(std::find(first_reset, bench.bus->frames.end(), std::string("601#2B4060000F000000")),
            bench.bus->frames.end());
}

TEST_F(MotionTrouble, AnExceptionOnTheWayLeavesNothingEnergised) {
  int samples = 0;
  bench.options.on_sample = [&](const MotionSample&) {
    if (++samples == 20) throw std::runtime_error("a bug");
  };
  EXPECT_THROW((void)bench.jog(kJog), std::runtime_error);
  EXPECT_GE(samples, 20);
  EXPECT_FALSE(bench.energised());
  EXPECT_EQ(bench.changed(), std::vector<std::string>{});
}

TEST_F(MotionTrouble, AClosedPipeEndsTheMotion) {
  int samples = 0;
  bench.options.unheard = [&] { return ++samples > 20; };
  expect_stopped(bench.jog(kJog), "the output is no longer read");
}

TEST_F(MotionTrouble, SignalsAreHeldBackUntilTheDriveIsAtRest) {
  std::vector<std::pair<session::Care, bool>> told;  // What was told, and whether the drive was energised.
  session::Protection protection([&](session::Care worst) { told.emplace_back(worst, bench.energised()); });
  bench.session->options().protection = &protection;
  ASSERT_TRUE(bench.jog(jog_for("60rpm", 200ms)).outcome);
  bench.session->options().protection = nullptr;
  const std::vector<std::pair<session::Care, bool>> expected{
      {session::Care::guarded, false}, {session::Care::unsettled, false}, {session::Care::none, false}};
  EXPECT_EQ(told, expected);
}

TEST_F(MotionTrouble, TheDriveWatchesServoctlOnlyWhileItMoves) {
  std::uint64_t watched = 0;
  bench.options.on_sample = [&](const MotionSample&) { watched = load_le(bench.drive().value({0x1016, 1})); };
  ASSERT_TRUE(bench.jog(jog_for("60rpm", 1s)).outcome);
  EXPECT_EQ(watched, 0x007F'01F4U);
  EXPECT_EQ(load_le(bench.drive().value({0x1016, 1})), 0U);
  const auto beats = std::count(bench.bus->frames.begin(), bench.bus->frames.end(), std::string("77F#05"));
  EXPECT_GE(beats, 14);
  bench.bus->frames.clear();
  bench.wait(2s);
  EXPECT_TRUE(bench.bus->frames.empty());
}

TEST_F(MotionTrouble, ServoctlTakesNoNodeIdThatSomebodyHas) {
  MotionBench own("gsd600@127,gsd600", 131072);
  const auto plan = plan_watchdog(*own.session, own.profile(), 1, {});
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->producer, 126);
  const auto of_the_drive = plan_watchdog(*own.session, own.profile(), 1, 1);
  ASSERT_FALSE(of_the_drive);
  EXPECT_EQ(of_the_drive.error().code, Errc::usage);
}

TEST_F(MotionTrouble, AWatchdogWithoutReactionIsGivenOneForTheTime) {
  MotionBench own("cia402", 10000);
  ASSERT_EQ(load_le(own.drive().value({0x6007, 0})), 0U);
  std::uint64_t option = 0;
  own.options.on_sample = [&](const MotionSample&) { option = load_le(own.drive().value({0x6007, 0})); };
  ASSERT_TRUE(own.jog(jog_for("60rpm", 200ms)).outcome);
  EXPECT_EQ(option, 1U);
  EXPECT_EQ(own.changed(), std::vector<std::string>{});
}

TEST_F(MotionTrouble, NothingOfAMotionIsWrittenToAFlashThatWears) {
  MotionBench own("ts", 10000);
  const auto before = own.drive().flash_writes();
  ASSERT_TRUE(own.jog(jog_for("60rpm", 500ms)).outcome);
  EXPECT_EQ(own.changed(), std::vector<std::string>{});
  EXPECT_EQ(own.drive().flash_writes(), before);
}

TEST_F(MotionTrouble, ANodeThatMustBeOperationalIsStartedAndPutBack) {
  MotionBench own("da200", 10000);
  auto while_moving = canopen::NmtState::stopped;
  own.options.on_sample = [&](const MotionSample&) { while_moving = own.drive().nmt_state(); };
  ASSERT_TRUE(own.jog(jog_for("60rpm", 200ms)).outcome);
  EXPECT_EQ(while_moving, canopen::NmtState::operational);
  EXPECT_EQ(own.drive().nmt_state(), canopen::NmtState::pre_operational);
}

TEST_F(MotionTrouble, KeysTurnWhileTheyAreHeld) {
  int looks = 0;
  Jog jog = jog_for("60rpm", 0s);
  jog.length.reset();
  jog.keys = [&] {
    ++looks;
    return looks < 40    ? HoldKey::plus
           : looks < 80  ? HoldKey::none
           : looks < 150 ? HoldKey::minus
                         : HoldKey::stop;
  };
  const auto done = bench.jog(jog);
  ASSERT_TRUE(done.outcome) << done.outcome.error().message.text();
  double most = 0;
  double least = 0;
  for (const auto& sample : done.samples) {
    most = std::max(most, sample[Signal::velocity].value_or(0));
    least = std::min(least, sample[Signal::velocity].value_or(0));
  }
  EXPECT_NEAR(most, 60, 1);
  EXPECT_NEAR(least, -60, 1);
  EXPECT_FALSE(bench.energised());
}

}  // namespace
}  // namespace servoctl::motion
