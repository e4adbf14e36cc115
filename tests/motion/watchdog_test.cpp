// Which watchdog a drive has, and what is promised of it before a motion.
#include "motion/watchdog.hpp"

#include "canopen/cob_id.hpp"
#include "canopen/nmt.hpp"
#include "motion/preflight.hpp"
#include "motion_support.hpp"

namespace servoctl::motion {
namespace {

using namespace std::chrono_literals;
using Kind = WatchdogPlan::Kind;

constexpr ObjectAddress kGuardingAlarm{0x2000, 0xC8};

/// A master that sends heartbeats and answers nothing.
class BeatingMaster final : public sim::Device {
 public:
  BeatingMaster(std::uint8_t node, Duration period, TimePoint first)
      : node_(node), period_(period), next_(first) {}

  void on_frame(const can::Frame& /*frame*/, TimePoint /*now*/) override {}
  void on_time(TimePoint now) override {
    for (; next_ <= now; next_ += period_) ++due_;
  }
  std::optional<can::Frame> take_frame() override {
    if (due_ == 0) return std::nullopt;
    --due_;
    return canopen::heartbeat_frame(node_, canopen::NmtState::operational);
  }
  TimePoint deadline() const override { return next_; }

 private:
  std::uint8_t node_;
  Duration period_;
  TimePoint next_;
  int due_ = 0;
};

class Watchdog : public testing::Test {
 protected:
  WatchdogPlan plan(std::optional<std::uint8_t> producer = {}) {
    auto out = plan_watchdog(*bench.session, bench.profile(), 1, producer);
    EXPECT_TRUE(out) << out.error().message.text();
    return out.value_or(WatchdogPlan{});
  }
  void write(ObjectAddress object, std::uint32_t value, std::size_t size) {
    const auto done = bench.session->download(1, object, store_le(value, size));
    ASSERT_TRUE(done) << done.error().message.text();
  }
  /// Other masters are watched by every entry of 1016h.
  void take_all_entries() {
    for (std::uint8_t entry = 1; entry <= 4; ++entry)
      write({0x1016, entry}, 0x0002'03E8U + (std::uint32_t{entry} << 16U), 4);
  }

  MotionBench bench{"gsd600", 131072};
};

TEST_F(Watchdog, AMasterThatOnlySendsHeartbeatsKeepsItsNodeId) {
  BeatingMaster plc(127, 900ms, bench.session->now() + 900ms);
  bench.bus->bus.attach(plc);
  const auto found = plan();
  EXPECT_EQ(found.kind, Kind::heartbeat);
  EXPECT_EQ(found.producer, 126);
  EXPECT_NE(to_string(found).find("as node 126"), std::string::npos) << to_string(found);
}

TEST_F(Watchdog, NobodyIsWaitedForWhereTheBusHasBeenHeardForLongEnough) {
  bench.wait(kListening);
  const auto begin = bench.session->now();
  EXPECT_EQ(plan().producer, 127);
  EXPECT_LT(bench.session->now() - begin, 200ms);
}

TEST_F(Watchdog, NobodyIsWaitedForWhereTheUserNamesTheNodeId) {
  const auto begin = bench.session->now();
  EXPECT_EQ(plan(std::uint8_t{100}).producer, 100);
  EXPECT_LT(bench.session->now() - begin, 200ms);
}

TEST_F(Watchdog, CtrlCEndsTheListening) {
  bench.session->options().cancelled = [] { return true; };
  const auto found = plan_watchdog(*bench.session, bench.profile(), 1, {});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, Errc::interrupted);
}

TEST_F(Watchdog, AnEntryThatWatchesTheNodeIdOfTheUserAlreadyIsUsedAgain) {  // CiA 301, 7.5.2.19
  write({0x1016, 3}, 0x0064'01F4, 4);
  const auto found = plan(std::uint8_t{100});
  EXPECT_EQ(found.kind, Kind::heartbeat);
  EXPECT_EQ(found.entry, 3);
}

TEST_F(Watchdog, AnEntryWithNoNodeIdIsFree) {
  write({0x1016, 1}, 0x00C8'01F4, 4);  // 200
  const auto found = plan();
  EXPECT_EQ(found.entry, 1);
  EXPECT_EQ(found.watched, std::set<std::uint8_t>{});
}

TEST_F(Watchdog, GuardingWhoseAlarmIsMaskedIsNotPromised) {
  take_all_entries();
  const auto found = plan();
  EXPECT_EQ(found.kind, Kind::none);
  const auto text = to_string(found);
  EXPECT_NE(text.find("nothing is known that stops the drive"), std::string::npos) << text;
  EXPECT_NE(text.find("all entries of 1016h are taken"), std::string::npos) << text;
  EXPECT_NE(text.find("Pn0199 is 0 (a change takes effect when the drive starts)"), std::string::npos)
      << text;
}

TEST_F(Watchdog, GuardingWhoseAlarmIsOnIsPromisedAsFarAsItCanBeKnown) {
  take_all_entries();
  write(kGuardingAlarm, 1, 2);
  const auto found = plan();
  EXPECT_EQ(found.kind, Kind::guarding);
  const auto text = to_string(found);
  EXPECT_NE(text.find("provided that Pn0199 was on when the drive started"), std::string::npos) << text;
  EXPECT_EQ(text.find("taken"), std::string::npos) << text;
}

TEST_F(Watchdog, GuardingIsNotPromisedOfADriveThatSendsHeartbeats) {
  take_all_entries();
  write(kGuardingAlarm, 1, 2);
  write({0x1017, 0}, 100, 2);
  const auto found = plan();
  EXPECT_EQ(found.kind, Kind::none);
  EXPECT_NE(to_string(found).find("1017h"), std::string::npos) << to_string(found);
}

/// Weight of the watchdog's line in what is shown before a motion.
PreflightItem::Weight weight(std::string_view family, WatchdogPlan::Kind kind) {
  MotionBench bench(family);
  const auto plan = plan_watchdog(*bench.session, bench.profile(), 1, {});
  EXPECT_TRUE(plan);
  EXPECT_EQ(plan->kind, kind) << family;
  return watchdog_item(*plan).weight;
}

/// CiA 301 promises another NMT state; what the motor does then is said by 6007h alone.
TEST(WatchdogLine, IsACautionWhereNoObjectTellsTheReaction) {
  WatchdogPlan plan;
  plan.kind = Kind::heartbeat;
  plan.time = kWatchdogTime;
  EXPECT_EQ(plan.stops(), Stops::unknown);
  EXPECT_NE(to_string(plan).find("NOT KNOWN is what the motor then does"), std::string::npos)
      << to_string(plan);
  plan.option = 1;
  EXPECT_EQ(plan.stops(), Stops::yes);
  EXPECT_EQ(to_string(plan).find("NOT KNOWN"), std::string::npos) << to_string(plan);
  plan.option = -1;  // CiA 402-2: manufacturer specific
  EXPECT_EQ(plan.stops(), Stops::unknown);
  plan.option = 1;
  plan.assumed = true;
  EXPECT_EQ(plan.stops(), Stops::unknown);
}

TEST(WatchdogLine, IsACautionWhereTheManualDoesNotTellTheReaction) {
  EXPECT_EQ(weight("cia402", Kind::heartbeat), PreflightItem::Weight::good);
  EXPECT_EQ(weight("gsd600", Kind::heartbeat), PreflightItem::Weight::caution);
  EXPECT_EQ(weight("dm", Kind::heartbeat), PreflightItem::Weight::caution);
  EXPECT_EQ(weight("ts", Kind::heartbeat), PreflightItem::Weight::caution);
  EXPECT_EQ(weight("da200", Kind::none), PreflightItem::Weight::caution);
  EXPECT_EQ(weight("sv2", Kind::none), PreflightItem::Weight::caution);
}

}  // namespace
}  // namespace servoctl::motion
