// Less knowledge never allows more: how fast a motor may turn of which nobody knows the counts of a turn.
#include <gtest/gtest.h>

#include "motion_support.hpp"

namespace servoctl::motion {
namespace {

template <class Kind>
Result<MotionPlan> plan_of(MotionBench& bench, const Kind& kind,
                           Result<MotionPlan> (*plan)(Motion&, const Kind&)) {
  Motion motion(*bench.session, bench.profile(), 1, bench.options);
  if (const auto ready = motion.prepare(); !ready) return fail(ready.error());
  return plan(motion, kind);
}

Home home_at_own_speeds() {
  Home out;
  out.method = "19";
  return out;
}

void expect_refused(const Result<MotionPlan>& plan, std::string_view why) {
  ASSERT_FALSE(plan);
  EXPECT_NE(plan.error().message.text().find(why), std::string::npos)
      << plan.error().message.text() << " | " << plan.error().hint.text();
}

/// 6099h:01 is 1310720 inc/s from the factory: 600 rpm with 17 bits, 2400 rpm with 15.
TEST(UnknownTurn, IsJudgedByTheFewestCountsOfTheFamily) {
  MotionBench bench("gsd600");
  const auto plan = plan_of(bench, home_at_own_speeds(), plan_home);
  expect_refused(plan, "is above the limit of 163840 inc/s");
  EXPECT_NE(plan.error().hint.text().find("at 32768 of them this speed is 2400 rpm"), std::string::npos)
      << plan.error().hint.text();
  bench.options.turn = 131072;
  expect_refused(plan_of(bench, home_at_own_speeds(), plan_home), "is above the limit of 300 rpm");
}

TEST(UnknownTurn, IsJudgedByWhatWasToldForThisDriveEarlier) {
  MotionBench bench("gsd600");
  bench.options.supposed_turn = 131072;
  expect_refused(plan_of(bench, home_at_own_speeds(), plan_home), "is above the limit of 655360 inc/s");
}

TEST(UnknownTurn, ASpeedThatTheUserAllowsIsAllowed) {
  MotionBench bench("gsd600");
  bench.options.speed_limit = "1310720inc/s";
  EXPECT_TRUE(plan_of(bench, home_at_own_speeds(), plan_home));
}

TEST(UnknownTurn, AMoveTakesAPartOfTheSlowestThatMayBeMeant) {
  MotionBench bench("gsd600");
  Move move;
  move.target = "1000inc";
  move.relative = true;
  const auto plan = plan_of(bench, move, plan_move);
  ASSERT_TRUE(plan) << plan.error().message.text();
  EXPECT_LE(plan->speed, 163840 / 5.0 + 1);
}

TEST(UnknownTurn, NeedsSpeedAndLimitWhereNothingTellsTheWorst) {
  MotionBench bench("gsd600");
  // Pn0462: the gear of the resolution is none that the manual explains.
  ASSERT_TRUE(
      bench.session->download(1, {0x2002, 0x3F}, store_le(2, bench.drive().value({0x2002, 0x3F}).size())));
  // The speeds of homing are the drive's own, and are compared with the limit.
  expect_refused(plan_of(bench, home_at_own_speeds(), plan_home), "no safe speed is known");
  bench.options.speed_limit = "1310720inc/s";
  EXPECT_TRUE(plan_of(bench, home_at_own_speeds(), plan_home));
  bench.options.speed_limit.clear();
  Move move;
  move.target = "1000inc";
  expect_refused(plan_of(bench, move, plan_move), "no speed given");
  move.speed = "100inc/s";
  expect_refused(plan_of(bench, move, plan_move), "no safe speed is known");
  bench.options.speed_limit = "100inc/s";
  const auto plan = plan_of(bench, move, plan_move);
  EXPECT_TRUE(plan) << plan.error().message.text();
}

/// The drive takes its method 35 where it stands.
TEST(UnknownTurn, IsNoMatterWhereNothingMoves) {
  MotionBench bench("gsd600");
  Home home;
  home.method = "35";
  EXPECT_TRUE(plan_of(bench, home, plan_home));
}

TEST(TorqueCeiling, EndsAMotionWhoseMotorNeedsMoreToAccelerate) {
  MotionBench bench("gsd600", 131072);
  bench.options.max_torque = "5%";
  const auto done = bench.jog(jog_for("240rpm", std::chrono::seconds(2)));
  ASSERT_FALSE(done.outcome);
  EXPECT_NE(done.outcome.error().message.text().find("torque"), std::string::npos)
      << done.outcome.error().message.text();
  EXPECT_TRUE(done.end.verified);
  bench.options.max_torque = "150%";
  EXPECT_TRUE(bench.jog(jog_for("240rpm", std::chrono::seconds(2))).outcome);
}

}  // namespace
}  // namespace servoctl::motion
