// Two servoctl on one bus: none feeds the watchdog of the other's drive.
#include "motion/producer_claim.hpp"

#include <array>
#include <thread>

#include "canopen/nmt.hpp"
#include "motion_support.hpp"
#include "tests/session/shared_wire.hpp"

namespace servoctl::motion {
namespace {

using namespace std::chrono_literals;

/// Two masters that begin at the same moment, each with a drive of its own.
class TwoMasters {
 public:
  explicit TwoMasters(std::string_view family, std::array<std::uint64_t, 2> seeds)
      : wire(std::string(family) + "@1," + std::string(family) + "@2") {
    sim::commission(wire.cell);
    for (std::size_t i = 0; i < 2; ++i) {
      auto bus = std::make_unique<session::SharedWire::Member>(wire);
      members[i] = bus.get();
      session::Options options;
      options.claim_seed = seeds[i];
      sessions[i] = std::make_unique<session::Session>(std::move(bus), "test", options);
    }
  }

  void jog(const Jog& kind) {
    std::array<std::thread, 2> threads;
    for (std::size_t i = 0; i < 2; ++i) threads[i] = std::thread([this, i, &kind] { jog_one(i, kind); });
    for (auto& thread : threads) thread.join();
  }

  bool energised(std::size_t i) { return drive::is_energised(wire.cell.drives[i]->power_state()); }

  session::SharedWire wire;
  std::array<session::SharedWire::Member*, 2> members{};
  std::array<std::unique_ptr<session::Session>, 2> sessions;
  std::array<MotionReport, 2> reports;
  std::function<void(std::size_t master, const MotionSample& sample)> on_sample;

 private:
  void jog_one(std::size_t i, const Jog& kind) {
    MotionOptions options;
    options.turn = wire.cell.profiles.front()->family == "ts" ? 10000 : 131072;
    if (on_sample) options.on_sample = [this, i](const MotionSample& sample) { on_sample(i, sample); };
    {
      Motion motion(*sessions[i], *wire.cell.profiles.front(), static_cast<std::uint8_t>(i + 1), options);
      auto& report = reports[i];
      report.outcome = motion.prepare();
      if (report.outcome) {
        const auto plan = plan_jog(motion, kind);
        if (plan)
          report = run_jog(motion, kind, *plan);
        else
          report.outcome = fail(plan.error());
      }
    }
    sessions[i].reset();  // It leaves the bus, so that the other goes on.
  }
};

TEST(ProducerClaim, TwoThatStartAtOnceTakeDifferentNumbers) {
  for (const auto& seeds : {std::array<std::uint64_t, 2>{0, 1}, {5, 2}, {0321, 0421}, {3, 0203}}) {
    TwoMasters two("gsd600", seeds);
    two.jog(jog_for("60rpm", 500ms));
    for (const auto& report : two.reports)
      EXPECT_TRUE(report.outcome) << (report.outcome ? "" : report.outcome.error().message.text());
    EXPECT_NE(two.reports[0].watchdog.producer, two.reports[1].watchdog.producer);
  }
}

TEST(ProducerClaim, ThoseWhoCannotBeToldApartDoNotMoveUnderOneNumber) {
  TwoMasters two("gsd600", {7, 7});
  two.jog(jog_for("60rpm", 500ms));
  const bool both = two.reports[0].outcome && two.reports[1].outcome;
  EXPECT_TRUE(!both || two.reports[0].watchdog.producer != two.reports[1].watchdog.producer);
}

TEST(ProducerClaim, TheDriveOfOneThatIsKilledStopsAlthoughTheOtherGoesOn) {
  for (const auto* family : {"gsd600", "dm", "ts"}) {
    TwoMasters two(family, {0, 1});
    int samples = 0;
    bool stopped = false;
    int samples_until = 0;
    two.on_sample = [&](std::size_t master, const MotionSample&) {
      if (master == 0 && ++samples == 10) two.members[0]->dead = true;
      if (master != 1 || samples < 10 || stopped) return;
      stopped = !two.energised(0);
      ++samples_until;
    };
    two.jog(jog_for("60rpm", 4s));
    EXPECT_TRUE(two.reports[1].outcome)
        << family << ": " << (two.reports[1].outcome ? "" : two.reports[1].outcome.error().message.text());
    EXPECT_TRUE(stopped) << family;
    EXPECT_LT(samples_until, 60) << family << ": a little more than half a second";
  }
}

TEST_F(MotionTrouble, AnotherWhoSendsHeartbeatsUnderServoctlsNumberEndsTheMotion) {
  int samples = 0;
  bench.options.on_sample = [&](const MotionSample&) {
    if (++samples == 20) bench.bus->injected.emplace_back("77F#05");
  };
  const auto done = bench.jog(kJog);
  expect_stopped(done, "another master sends heartbeats as node 127 (0x77F)");
  EXPECT_LE(samples, 22);
}

TEST_F(MotionTrouble, ANumberThatIsContestedWhileItIsClaimedIsLeftToTheOther) {
  bench.bus->alter = [&](can::Frame&) {};
  bool contested = false;
  bench.bus->swallows = [&](const std::string& frame) {
    if (frame == "77F#05" && !contested) {
      contested = true;
      bench.bus->injected.emplace_back("77F#05");
    }
    return false;
  };
  const auto done = bench.jog(jog_for("60rpm", 200ms));
  EXPECT_TRUE(done.outcome) << done.outcome.error().message.text();
  EXPECT_TRUE(contested);
  EXPECT_EQ(done.watchdog.producer, 126);
}

TEST_F(MotionTrouble, ANumberTheUserNamedIsRefusedWhenSomebodyHasIt) {
  bench.options.producer = 100;
  bench.started = [&] { bench.bus->injected.emplace_back("764#05"); };
  const auto during = bench.jog(kJog);
  ASSERT_FALSE(during.outcome);
  EXPECT_EQ(during.outcome.error().code, Errc::refused);
  EXPECT_FALSE(bench.energised());
  bench.started = {};
  const auto before = bench.jog(kJog);
  ASSERT_FALSE(before.outcome);
  EXPECT_EQ(before.outcome.error().code, Errc::refused);
  for (const auto& frame : bench.bus->frames) EXPECT_FALSE(frame.starts_with("601#2")) << frame;
}

TEST_F(MotionTrouble, AClaimTakesATenthOfASecond) {
  bench.wait(kListening);
  WatchdogPlan plan;
  plan.kind = WatchdogPlan::Kind::heartbeat;
  plan.producer = 127;
  const auto begin = bench.session->now();
  ASSERT_TRUE(claim_producer(*bench.session, 1, {}, plan));
  EXPECT_LE(bench.session->now() - begin, 111ms);
  EXPECT_EQ(std::count(bench.bus->frames.begin(), bench.bus->frames.end(), "77F#05"), 1);
}

}  // namespace
}  // namespace servoctl::motion
