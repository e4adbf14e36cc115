// Motions of drives on a ring: in OP, by the process image, and back to PRE-OP without power.
#include <gtest/gtest.h>

#include "drive/standard_objects.hpp"
#include "motion/power.hpp"
#include "motion_support.hpp"
#include "tests/session/ethercat_world.hpp"

namespace servoctl::motion {
namespace {

using namespace std::chrono_literals;
using drive::DriveState;

class EtherCatMotion : public session::EtherCatTest {
 protected:
  void SetUp() override {
    open("sv2@1");
    network().learn(1, rules());
  }
  const drive::Profile& profile() { return *port_->cell().profiles.front(); }

  template <class Kind>
  MotionReport run(const Kind& kind, Result<MotionPlan> (*plan)(Motion&, const Kind&),
                   MotionReport (*go)(Motion&, const Kind&, const MotionPlan&)) {
    MotionReport out;
    Motion motion(*session_, profile(), 1, options_);
    const auto ready = motion.prepare();
    EXPECT_TRUE(ready) << ready.error().message;
    const auto made = plan(motion, kind);
    EXPECT_TRUE(made) << made.error().message;
    before_ = objects();
    return go(motion, kind, *made);
  }
  MotionReport jog(std::string speed = "60rpm", Duration length = 1s) {
    return run(jog_for(std::move(speed), length), plan_jog, run_jog);
  }

  /// Every value a master can set, but the controlword, and 607Ah, which holds where the axis stood when OP
  /// began.
  std::map<std::string, Bytes> objects() {
    std::map<std::string, Bytes> out;
    for (const auto& object : profile().dictionary.objects())
      for (const auto& entry : object.entries) {
        Bytes value;
        if (entry.access == od::Access::rw && entry.address.index != 0x6040 &&
            entry.address.index != 0x607A && slave().model().read(entry.address, value) == 0)
          out[to_string(entry.address)] = value;
      }
    return out;
  }
  std::vector<std::string> changed() {
    std::vector<std::string> out;
    for (const auto& [name, bytes] : objects())
      if (bytes != before_[name]) out.push_back(name + " is " + to_hex(bytes));
    return out;
  }
  void expect_left_alone(const MotionReport& done) {
    EXPECT_TRUE(done.outcome) << done.outcome.error().message;
    EXPECT_TRUE(done.end.verified);
    EXPECT_EQ(done.end.notes, std::vector<std::string>{});
    EXPECT_EQ(done.end.left, std::vector<std::string>{});
    expect_safe();
    EXPECT_EQ(slave().state(), sim::EscState::pre_op);
    EXPECT_EQ(slave().al_code(), 0);
    EXPECT_EQ(changed(), std::vector<std::string>{});
  }
  void expect_safe() {
    EXPECT_FALSE(drive::is_energised(slave().model().power_state()));
    EXPECT_FALSE(slave().model().is_moving());
  }
  /// The wire is not there from that time of the motion on.
  void cut_after(Duration time) {
    options_.on_sample = [this, time,
                          begin = std::optional<TimePoint>()](const MotionSample& sample) mutable {
      if (!begin) begin = sample.time;
      if (sample.time - *begin >= time) ring().cut_cable(0);
    };
  }

  MotionOptions options_;
  std::map<std::string, Bytes> before_;
};

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
  ASSERT_TRUE(items) << items.error().message;
  const auto state =
      std::find_if(items->begin(), items->end(), [](const auto& i) { return i.what == "state"; });
  ASSERT_NE(state, items->end());
  EXPECT_EQ(state->weight, PreflightItem::Weight::note) << state->text;
  EXPECT_NE(state->text.find("it is looked at again in OP"), std::string::npos) << state->text;
  const auto done = run(jog_for("60rpm", 1s), plan_jog, run_jog);
  EXPECT_TRUE(done.outcome) << done.outcome.error().message;
  expect_safe();
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
  EXPECT_NE(notices.front().find("frames lost"), std::string::npos) << notices.front();
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
  EXPECT_TRUE(done.outcome) << done.outcome.error().message;
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
  EXPECT_TRUE(done.front().second);
  expect_safe();
  EXPECT_EQ(slave().state(), sim::EscState::pre_op);
}

/// Enabled in the way `enable` does it, and disabled in the way of `disable` and `quick-stop`.
PowerDownResult enabled_and_taken_down(session::Session& session, const drive::Profile& profile,
                                       PowerAim aim) {
  Motion motion(session, profile, 1, {});
  EXPECT_TRUE(motion.prepare());
  MotionGuard guard(session, motion.units(), 1);
  EXPECT_TRUE(guard.start_node());
  EXPECT_TRUE(guard.neutral_targets());
  EXPECT_TRUE(guard.enable());
  EXPECT_TRUE(guard.release());
  std::vector<PowerDownPlan> plans(1);
  plans.front().node = 1;
  plans.front().aim = aim;
  return take_down(session, std::move(plans)).front();
}

TEST_F(EtherCatMotion, ADriveThatTheUserHasInOpStaysThereWhenItIsEnabledAndDisabled) {
  for (const auto aim : {PowerAim::disable, PowerAim::stop}) {
    ASSERT_TRUE(network().request_state(1, session::NodeState::operational));
    network().keep_operational(1);
    const auto done = enabled_and_taken_down(*session_, profile(), aim);
    EXPECT_TRUE(done.outcome);
    EXPECT_EQ(done.notes, std::vector<std::string>{});
    expect_safe();
    pass(500ms);
    EXPECT_EQ(slave().state(), sim::EscState::op);
    EXPECT_EQ(session_->upload(1, objects::kTargetPosition).value(),
              session_->upload(1, objects::kPositionActual).value());
    ASSERT_TRUE(network().request_state(1, session::NodeState::pre_operational));
    EXPECT_FALSE(network().stays_operational(1)) << "the user wants another state now";
  }
}

TEST_F(EtherCatMotion, ADriveThatEnableTookToOpLeavesItWithItsPower) {
  const auto done = enabled_and_taken_down(*session_, profile(), PowerAim::disable);
  EXPECT_TRUE(done.outcome);
  expect_safe();
  EXPECT_EQ(slave().state(), sim::EscState::pre_op);
}

TEST_F(EtherCatMotion, WhenEverythingEndsADriveThatTheUserHadInOpEndsInPreOp) {
  ASSERT_TRUE(network().request_state(1, session::NodeState::operational));
  network().keep_operational(1);
  session_->energised().insert(1);
  ASSERT_TRUE(de_energise(*session_).front().second);
  EXPECT_EQ(slave().state(), sim::EscState::pre_op);
}

TEST_F(EtherCatMotion, ADriveThatFellOutOfOpIsNotTakenThereByDisable) {
  ASSERT_TRUE(network().request_state(1, session::NodeState::operational));
  network().keep_operational(1);
  slave().plan_fall({session_->now() + 50ms, sim::EscState::safe_op, 0x001A});
  pass(500ms);
  EXPECT_FALSE(network().stays_operational(1));
  EXPECT_TRUE(Power(*session_, profile(), 1).disable());
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
