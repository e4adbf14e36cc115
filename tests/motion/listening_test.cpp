// Others are listened to for a second before a motor moves, and not before what moves nothing.
#include "motion_support.hpp"

namespace servoctl::motion {
namespace {

using namespace std::chrono_literals;

class ListeningToOthers : public testing::TestWithParam<std::string_view> {
 protected:
  Duration since_begin() const { return bench.session->now() - begin; }

  MotionBench bench{GetParam(), GetParam() == "cia402" ? 10000. : 0.};
  TimePoint begin = bench.session->now();
};

TEST_P(ListeningToOthers, ComesBehindEverythingThatIsRefusedByReading) {
  Motion motion(*bench.session, bench.profile(), 1, bench.options);
  ASSERT_TRUE(motion.prepare());
  EXPECT_FALSE(plan_jog(motion, jog_for("60", 1s)));
  EXPECT_LT(since_begin(), 500ms);
}

TEST_P(ListeningToOthers, IsLeftOutWhereTheDriveRefusesTheMotion) {
  Power power(*bench.session, bench.profile(), 1);
  const auto on = power.reach(drive::DriveState::operation_enabled);
  ASSERT_TRUE(on) << on.error().message.text();
  begin = bench.session->now();
  Motion motion(*bench.session, bench.profile(), 1, bench.options);
  ASSERT_TRUE(motion.prepare());
  const auto items = motion.look(false);
  ASSERT_TRUE(items) << items.error().message.text();
  EXPECT_FALSE(check_preflight(*items, 1));
  EXPECT_LT(since_begin(), 500ms);
}

TEST_P(ListeningToOthers, IsLeftOutInARehearsalWhichSaysSo) {
  bench.options.rehearsal = true;
  Motion motion(*bench.session, bench.profile(), 1, bench.options);
  ASSERT_TRUE(motion.prepare());
  const auto items = motion.look(false);
  ASSERT_TRUE(items) << items.error().message.text();
  EXPECT_LT(since_begin(), 500ms);
  EXPECT_NE(items->back().text.find("before it moves, servoctl listens for 1 s"), std::string::npos)
      << items->back().text;
}

TEST_P(ListeningToOthers, IsDoneBeforeAMotionBeginsWhateverWasLookedAt) {
  Motion motion(*bench.session, bench.profile(), 1, bench.options);
  ASSERT_TRUE(motion.prepare());
  const auto plan = plan_jog(motion, jog_for("30rpm", 100ms));
  ASSERT_TRUE(plan) << plan.error().message.text();
  (void)run_jog(motion, jog_for("30rpm", 100ms), *plan);
  EXPECT_GT(since_begin(), kListening - 100ms);
  EXPECT_EQ(motion.watchdog().kind, WatchdogPlan::Kind::heartbeat);
}

INSTANTIATE_TEST_SUITE_P(Families, ListeningToOthers, testing::Values("cia402", "dm"),
                         [](const auto& one) { return std::string(one.param); });

}  // namespace
}  // namespace servoctl::motion
