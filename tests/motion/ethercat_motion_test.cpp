// Motions of drives on a ring: in OP, by the process image, and back to PRE-OP without power.
#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "drive/standard_objects.hpp"
#include "ethercat_motion.hpp"
#include "motion/power.hpp"

namespace servoctl::motion {
namespace {

using namespace std::chrono_literals;
using drive::DriveState;

TEST_F(EtherCatMotion, JogTurnsForATimeAndLeavesNothingBehind) {
  const auto done = jog();
  expect_left_alone(done);
  double greatest = 0;
  for (const auto& sample : done.samples) greatest = std::max(greatest, *sample[Signal::velocity]);
  EXPECT_NEAR(greatest, 60, 1);
}

TEST_F(EtherCatMotion, MoveHomeAndTorqueDoSoToo) {
  expect_left_alone(run(move_to("180deg", "60rpm"), plan_move, run_move));
  expect_left_alone(run(home_by("35"), plan_home, run_home));
  Torque torque;
  torque.torque = "5%";
  torque.length = 500ms;
  expect_left_alone(run(torque, plan_torque, run_torque));
}

TEST_F(EtherCatMotion, ADriveThatRunsItsStateMachineInOpOnlyIsLookedAtAgainThere) {
  slave().faults().sleeps_outside_op = true;
  EXPECT_EQ(session_->upload(1, objects::kStatusword).value(), (Bytes{0, 0}));
  Motion motion(*session_, profile(), 1, options_);
  ASSERT_TRUE(motion.prepare());
  const auto items = motion.look(false);
  ASSERT_TRUE(items) << items.error().message.text();
  const auto state =
      std::find_if(items->begin(), items->end(), [](const auto& i) { return i.what == "state"; });
  ASSERT_NE(state, items->end());
  EXPECT_EQ(state->weight, PreflightItem::Weight::note) << state->text;
  EXPECT_NE(state->text.find("it is looked at again in OP"), std::string::npos) << state->text;
  const auto done = run(jog_for("60rpm", 1s), plan_jog, run_jog);
  EXPECT_TRUE(done.outcome) << done.outcome.error().message.text();
  expect_safe();
}

/// A drive that tells nothing outside OP; what it tells there comes before the first controlword.
class AsleepOutsideOp : public EtherCatMotion {
 protected:
  void SetUp() override {
    EtherCatMotion::SetUp();
    slave().faults().sleeps_outside_op = true;
  }
  MotionReport looked_at_jog() {
    Motion motion(*session_, profile(), 1, options_);
    EXPECT_TRUE(motion.prepare());
    EXPECT_TRUE(motion.look(false));
    const auto kind = jog_for("60rpm", 1s);
    const auto plan = plan_jog(motion, kind);
    EXPECT_TRUE(plan);
    if (before_op) before_op();
    on_sent_ = [this] {
      was_commanded = was_commanded || slave().model().values().number(objects::kControlword) != 0;
    };
    return run_jog(motion, kind, *plan);
  }
  void expect_refused(const MotionReport& done, std::string_view why) {
    ASSERT_FALSE(done.outcome);
    EXPECT_EQ(done.outcome.error().code, Errc::refused);
    EXPECT_NE(done.outcome.error().message.text().find(why), std::string::npos)
        << done.outcome.error().message.text();
    EXPECT_FALSE(was_commanded);
    EXPECT_TRUE(done.samples.empty());
    expect_safe();
    EXPECT_EQ(slave().state(), sim::EscState::pre_op);
  }

  std::function<void()> before_op;
  bool was_commanded = false;
};

TEST_F(AsleepOutsideOp, OneThatObeysItsPanelIsRefusedInOp) {
  slave().model().misbehaviour().statusword = 0x0050;  // Switch on disabled, bit 9 (remote) is 0.
  expect_refused(looked_at_jog(), "bit 9 (remote) is 0");
}

TEST_F(AsleepOutsideOp, OneInFaultIsRefusedInOp) {
  slave().model().misbehaviour().statusword = 0x0218;
  expect_refused(looked_at_jog(), "fault");
}

TEST_F(AsleepOutsideOp, ACautionThatShowsInOpOnlyIsAskedAbout) {
  before_op = [this] { slave().model().misbehaviour().statusword = 0x0A50; };  // Bit 11: internal limit.
  expect_refused(looked_at_jog(), "bit 11");
  std::vector<PreflightItem> asked;
  options_.ask_again = [&](const std::vector<PreflightItem>& unseen) -> Result<void> {
    asked = unseen;
    return fail(Errc::refused, "not confirmed");
  };
  slave().model().misbehaviour().statusword.reset();
  expect_refused(looked_at_jog(), "not confirmed");
  ASSERT_EQ(asked.size(), 1U);
  EXPECT_EQ(asked.front().what, "limit");
}

TEST_F(EtherCatMotion, TheWatchdogIsThatOfTheSyncManager) {
  const auto plan = plan_watchdog(*session_, profile(), 1, {});
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->kind, WatchdogPlan::Kind::sync_manager);
  EXPECT_EQ(plan->time, 100ms);
  EXPECT_TRUE(plan->assumed);
  EXPECT_EQ(plan_watchdog(*session_, profile(), 1, std::uint8_t{127}).error().code, Errc::usage);
}

TEST_F(EtherCatMotion, LostFramesAreToldAndStopNothing) {
  ring().faults().loses_every = 9;
  expect_left_alone(jog());
  const auto notices = network().take_notices();
  ASSERT_FALSE(notices.empty());
  EXPECT_NE(notices.front().text().find("frames lost"), std::string::npos) << notices.front().text();
}

TEST_F(EtherCatMotion, WhereTheCableIsCutTheDriveStopsByItselfAndNothingIsPromised) {
  cut_after(300ms);
  const auto done = jog("60rpm", 5s);
  EXPECT_FALSE(done.outcome);
  EXPECT_FALSE(done.end.verified);
  EXPECT_TRUE(session_->energised().contains(1));
  pass(200ms);
  expect_safe();
}

TEST_F(EtherCatMotion, ADriveThatFallsOutOfOpEndsTheMotionWithItsReason) {
  options_.on_sample = [this, planned = false](const MotionSample& sample) mutable {
    if (!std::exchange(planned, true))
      slave().plan_fall({sample.time + 400ms, sim::EscState::safe_op, 0x001A});
  };
  const auto done = jog("60rpm", 5s);
  ASSERT_FALSE(done.outcome);
  expect_safe();
  EXPECT_TRUE(done.end.verified);
  EXPECT_EQ(slave().state(), sim::EscState::pre_op);
}

TEST_F(EtherCatMotion, CtrlCEndsItInPreOpWithoutPower) {
  bool pressed = false;
  session_->options().cancelled = [&] { return pressed; };
  options_.on_sample = [&, begin = std::optional<TimePoint>()](const MotionSample& sample) mutable {
    if (!begin) begin = sample.time;
    pressed = sample.time - *begin > 300ms;
  };
  const auto done = jog("60rpm", 5s);
  ASSERT_FALSE(done.outcome);
  EXPECT_EQ(done.outcome.error().code, Errc::interrupted);
  EXPECT_TRUE(done.end.verified);
  expect_safe();
  EXPECT_EQ(slave().state(), sim::EscState::pre_op);
  EXPECT_EQ(changed(), std::vector<std::string>{});
}

TEST_F(EtherCatMotion, ADriveThatWasInOpIsBackInOpBehindAMotionWithItsTargetWhereItStands) {
  ASSERT_TRUE(network().request_state(1, session::NodeState::operational));
  const auto done = jog();
  EXPECT_TRUE(done.outcome) << done.outcome.error().message.text();
  EXPECT_TRUE(done.end.verified);
  EXPECT_EQ(done.end.notes, std::vector<std::string>{});
  expect_safe();
  EXPECT_EQ(slave().state(), sim::EscState::op);
  ASSERT_TRUE(network().must_go_on());
  pass(500ms);
  EXPECT_EQ(slave().state(), sim::EscState::op);
  expect_safe();
  EXPECT_EQ(session_->upload(1, objects::kTargetPosition).value(),
            session_->upload(1, objects::kPositionActual).value());
  EXPECT_EQ(session_->upload(1, objects::kTargetVelocity).value(), (Bytes{0, 0, 0, 0}));
}

TEST_F(EtherCatMotion, ADriveThatWasInOpAndFellOutOfItIsNotTakenThereAgain) {
  ASSERT_TRUE(network().request_state(1, session::NodeState::operational));
  options_.on_sample = [this, planned = false](const MotionSample& sample) mutable {
    if (!std::exchange(planned, true))
      slave().plan_fall({sample.time + 400ms, sim::EscState::safe_op, 0x001A});
  };
  const auto done = jog("60rpm", 5s);
  ASSERT_FALSE(done.outcome);
  expect_safe();
  EXPECT_EQ(slave().state(), sim::EscState::pre_op);
  EXPECT_EQ(done.end.notes,
            std::vector<std::string>{"it was in OP before and is in PRE-OP now: it left it by itself"});
}

TEST_F(EtherCatMotion, ADriveInOpThatIsRefusedBeforeItHasPowerStaysInOp) {
  ASSERT_TRUE(network().request_state(1, session::NodeState::operational));
  Motion motion(*session_, profile(), 1, {});
  ASSERT_TRUE(motion.prepare());
  {
    MotionGuard guard(*session_, motion.units(), 1);
    WatchdogPlan plan;
    plan.kind = WatchdogPlan::Kind::sync_manager;
    plan.time = 100ms;
    ASSERT_TRUE(guard.start_node());
    ASSERT_TRUE(guard.arm(plan));
  }
  pass(500ms);
  EXPECT_EQ(slave().state(), sim::EscState::op);
  EXPECT_TRUE(network().must_go_on());
}

TEST_F(EtherCatMotion, ADriveThatWasEnabledIsHeldAndLetGo) {
  Motion motion(*session_, profile(), 1, {});
  ASSERT_TRUE(motion.prepare());
  MotionGuard guard(*session_, motion.units(), 1);
  ASSERT_TRUE(guard.start_node());
  ASSERT_TRUE(guard.neutral_targets());
  ASSERT_TRUE(guard.enable());
  ASSERT_TRUE(guard.release());
  pass(2s);
  EXPECT_TRUE(drive::is_energised(slave().model().power_state()));
  EXPECT_TRUE(network().must_go_on());
  const auto done = de_energise(*session_);
  ASSERT_EQ(done.size(), 1U);
  EXPECT_TRUE(done.front().outcome);
  expect_safe();
  EXPECT_EQ(slave().state(), sim::EscState::pre_op);
}

TEST_F(EtherCatMotion, AProgramThatIsGoneLeavesADriveWithoutPower) {
  Motion motion(*session_, profile(), 1, {});
  ASSERT_TRUE(motion.prepare());
  MotionGuard guard(*session_, motion.units(), 1);
  ASSERT_TRUE(guard.start_node());
  ASSERT_TRUE(guard.enable());
  EXPECT_TRUE(drive::is_energised(slave().model().power_state()));
  for (const auto end = port_->now() + 150ms; port_->now() < end;)
    ASSERT_TRUE(port_->receive(end));  // Nobody sends any more.
  expect_safe();
  EXPECT_EQ(slave().al_code(), 0x001B);
}

}  // namespace
}  // namespace servoctl::motion
