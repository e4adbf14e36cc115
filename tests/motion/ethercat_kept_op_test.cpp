// A drive that the user has in OP stays there, whatever is done with its power.
#include <gtest/gtest.h>

#include "ethercat_motion.hpp"
#include "motion/power.hpp"

namespace servoctl::motion {
namespace {

using EtherCatKeptOp = EtherCatMotion;

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

TEST_F(EtherCatKeptOp, ADriveThatTheUserHasInOpStaysThereWhenItIsEnabledAndDisabled) {
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

TEST_F(EtherCatKeptOp, ADriveThatEnableTookToOpLeavesItWithItsPower) {
  const auto done = enabled_and_taken_down(*session_, profile(), PowerAim::disable);
  EXPECT_TRUE(done.outcome);
  expect_safe();
  EXPECT_EQ(slave().state(), sim::EscState::pre_op);
}

TEST_F(EtherCatKeptOp, WhenEverythingEndsADriveThatTheUserHadInOpEndsInPreOp) {
  ASSERT_TRUE(network().request_state(1, session::NodeState::operational));
  network().keep_operational(1);
  session_->energised().insert(1);
  ASSERT_TRUE(de_energise(*session_).front().outcome);
  EXPECT_EQ(slave().state(), sim::EscState::pre_op);
}

TEST_F(EtherCatKeptOp, ADriveThatFellOutOfOpIsNotTakenThereByDisable) {
  ASSERT_TRUE(network().request_state(1, session::NodeState::operational));
  network().keep_operational(1);
  slave().plan_fall({session_->now() + 50ms, sim::EscState::safe_op, 0x001A});
  pass(500ms);
  EXPECT_FALSE(network().stays_operational(1));
  EXPECT_TRUE(Power(*session_, profile(), 1).disable());
  EXPECT_EQ(slave().state(), sim::EscState::pre_op);
}

}  // namespace
}  // namespace servoctl::motion
