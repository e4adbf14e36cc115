// What stops a drive without a heartbeat consumer (1016h) when servoctl or the cable dies: life guarding.
#include <algorithm>

#include "motion_support.hpp"
#include "session/can_network.hpp"

namespace servoctl::motion {
namespace {

using namespace std::chrono_literals;
using drive::DriveState;

constexpr ObjectAddress kGuardTime{0x100C, 0};
constexpr ObjectAddress kLifeFactor{0x100D, 0};
constexpr const char* kQuestion = "701#R";

class LifeGuarding : public testing::TestWithParam<const char*> {
 protected:
  LifeGuarding() { bench.drive().misbehaviour().missing = {0x1016}; }

  long questions() const {
    const auto& frames = bench.bus->frames;
    return std::count_if(frames.begin(), frames.end(),
                         [](const auto& f) { return f.starts_with(kQuestion); });
  }
  WatchdogPlan plan() {
    const auto out = plan_watchdog(*bench.session, bench.profile(), 1, {});
    EXPECT_TRUE(out);
    return out.value_or(WatchdogPlan{});
  }
  std::uint64_t value(ObjectAddress object) { return load_le(bench.drive().value(object)); }

  MotionBench bench{GetParam(), 10000};
};

TEST_P(LifeGuarding, IsWhatWatchesADriveWithoutAHeartbeatConsumer) {
  EXPECT_EQ(plan().kind, WatchdogPlan::Kind::guarding);
  std::pair<std::uint64_t, std::uint64_t> set;
  bench.options.on_sample = [&](const MotionSample&) { set = {value(kGuardTime), value(kLifeFactor)}; };
  const auto done = bench.jog(jog_for("60rpm", 2s));
  ASSERT_TRUE(done.outcome) << done.outcome.error().message.text();
  EXPECT_EQ(set, std::pair(std::uint64_t{200}, std::uint64_t{5}));
  EXPECT_GE(questions(), 10);  // Five in the time of the watchdog, which is a second.
  EXPECT_EQ(bench.drive().power_state(), DriveState::switch_on_disabled);
}

TEST_P(LifeGuarding, IsOverWhenTheMotionIs) {
  ASSERT_TRUE(bench.jog(jog_for("60rpm", 500ms)).outcome);
  EXPECT_EQ(bench.changed(), std::vector<std::string>{});
  bench.bus->frames.clear();
  bench.wait(5s);
  EXPECT_EQ(questions(), 0);
  EXPECT_EQ(bench.drive().power_state(), DriveState::switch_on_disabled) << "no alarm of the silence";
}

TEST_P(LifeGuarding, StopsTheDriveByItselfWhenTheBusIsLost) {
  bench.started = [&] { bench.bus->lost_after = bench.bus->sent + 250; };
  const auto done = bench.jog(jog_for("60rpm", 10s));
  ASSERT_FALSE(done.outcome);
  EXPECT_FALSE(done.end.verified);
  EXPECT_EQ(done.watchdog.kind, WatchdogPlan::Kind::guarding);
  EXPECT_TRUE(bench.energised());
  EXPECT_TRUE(bench.drive().is_moving());
  bench.wait(done.watchdog.time + 30ms);
  EXPECT_FALSE(bench.energised());
  EXPECT_FALSE(bench.drive().is_moving());
}

TEST_P(LifeGuarding, StopsTheDriveByItselfWhenTheCableIsOut) {
  bench.started = [&] { bench.drive().fall_silent_at(bench.session->now() + 600ms); };
  const auto done = bench.jog(jog_for("60rpm", 10s));
  ASSERT_FALSE(done.outcome);
  bench.wait(done.watchdog.time + 30ms);
  EXPECT_FALSE(bench.energised());
}

TEST_P(LifeGuarding, IsNoWatchdogWhereTheDriveSendsHeartbeatsItself) {
  ASSERT_TRUE(bench.session->download(1, {0x1017, 0}, {0xF4, 0x01}));
  EXPECT_EQ(plan().kind, WatchdogPlan::Kind::none);
}

TEST_P(LifeGuarding, TakesOverWhereAllOfTheConsumersEntriesAreTaken) {
  bench.drive().misbehaviour().missing.clear();
  for (std::uint8_t entry = 1; entry <= 5; ++entry)
    (void)bench.session->download(1, {0x1016, entry}, store_le(std::uint32_t{entry + 10U} << 16U | 500U, 4));
  EXPECT_EQ(plan().kind, WatchdogPlan::Kind::guarding);
}

INSTANTIATE_TEST_SUITE_P(Families, LifeGuarding, testing::Values("cia402", "dm"),
                         [](const auto& one) { return std::string(one.param); });

class MaskedGuarding : public LifeGuarding {
 protected:
  static constexpr ObjectAddress kAlarm{0x2000, 0xC8};  // Pn0199; 0 masks it (2703 of the manual).
};

TEST_P(MaskedGuarding, IsNone) {
  EXPECT_EQ(value(kAlarm), 0U);
  EXPECT_EQ(plan().kind, WatchdogPlan::Kind::none);
}

TEST_P(MaskedGuarding, StopsTheDriveOnceTheAlarmIsThere) {
  ASSERT_TRUE(bench.session->download(1, kAlarm, {1, 0}));
  ASSERT_TRUE(bench.session->can()->send(canopen::nmt_frame(canopen::NmtCommand::reset_node, 1)));
  bench.wait(500ms);
  bench.started = [&] { bench.bus->lost_after = bench.bus->sent + 250; };
  const auto done = bench.jog(jog_for("60rpm", 10s));
  EXPECT_EQ(done.watchdog.kind, WatchdogPlan::Kind::guarding);
  EXPECT_TRUE(bench.energised());
  bench.wait(done.watchdog.time + 30ms);
  EXPECT_FALSE(bench.energised());
}

INSTANTIATE_TEST_SUITE_P(Families, MaskedGuarding, testing::Values("gsd600"),
                         [](const auto& one) { return std::string(one.param); });

}  // namespace
}  // namespace servoctl::motion
