// What happens to a drive behind the back of a motion, and what of it is put back.
#include <algorithm>
#include <utility>

#include "motion_support.hpp"
#include "session/can_network.hpp"

namespace servoctl::motion {
namespace {

using namespace std::chrono_literals;
using drive::DriveState;

/// A question may stand for minutes before it is answered; whatever happened to the drive meanwhile counts.
TEST_F(MotionTrouble, AWayThatWasToldFromElsewhereIsNotGone) {
  bench.started = [&] {
    bench.started = {};
    const auto others = bench.jog(jog_turns("60rpm", 2));
    ASSERT_TRUE(others.outcome) << others.outcome.error().message.text();
  };
  const auto before = bench.session->now();
  const auto done = bench.move(move_to("90deg", "60rpm", true));
  ASSERT_FALSE(done.outcome);
  EXPECT_EQ(done.outcome.error().code, Errc::refused);
  EXPECT_NE(done.outcome.error().message.text().find("has moved since"), std::string::npos);
  EXPECT_FALSE(done.begun);
  EXPECT_LT(bench.session->now() - before, 5s);
}

TEST_F(MotionTrouble, ADriveThatSomebodyElseHasEnabledMeanwhileIsNotTouched) {
  bench.started = [&] {
    ASSERT_TRUE(Power(*bench.session, bench.profile(), 1).reach(DriveState::operation_enabled));
    bench.bus->frames.clear();
  };
  const auto done = bench.jog(kJog);
  ASSERT_FALSE(done.outcome);
  EXPECT_EQ(done.outcome.error().code, Errc::refused);
  EXPECT_NE(done.outcome.error().message.text().find("somebody else"), std::string::npos);
  EXPECT_FALSE(done.begun);
  EXPECT_TRUE(bench.energised()) << "it belongs to the other master";
  for (const auto& frame : bench.bus->frames) EXPECT_EQ(frame.substr(0, 6), "601#40") << frame;
}

/// Answers to another servoctl come with the same CAN-ID.
TEST_F(MotionTrouble, AnswersToOtherMastersFromBeforeAreNotTakenForItsOwn) {
  bench.started = [&] { bench.bus->injected = {"581#4B41600037060000"}; };  // Operation enabled.
  const auto done = bench.jog(jog_for("60rpm", 200ms));
  EXPECT_TRUE(done.outcome) << done.outcome.error().message.text();
}

TEST_F(MotionTrouble, ARunawayInTheRightDirectionIsStopped) {
  bench.bus->alter = [](can::Frame& frame) {
    if (can::to_string(frame).substr(0, 12) != "581#436C6000") return;
    const auto speed = std::span(frame.data).subspan(4, 4);
    store_le(load_le(speed) * 2, speed);
  };
  expect_stopped(bench.jog(kJog), "the speed of");
}

TEST_F(MotionTrouble, TheWatchdogIsLeftAloneWithADriveThatDoesNotAnswer) {
  const auto silent = bench.session->now() + kListening + 700ms;
  bench.drive().fall_silent_at(silent);
  const auto done = bench.jog(kJog);
  ASSERT_EQ(done.watchdog.kind, WatchdogPlan::Kind::heartbeat);
  ASSERT_GT(bench.bus->last_heartbeat, silent - 200ms);
  EXPECT_LT(bench.bus->last_heartbeat - silent, 1s);
}

/// From "operation enabled" on every controlword is lost, and seems to be taken.
void lose_controlwords(MotionBus& bus) {
  bus.swallows = [&bus, up = false](const std::string& frame) mutable {
    if (frame.substr(0, 12) != "601#2B406000") return false;
    if (up) bus.injected.emplace_back("581#6040600000000000");
    return std::exchange(up, up || frame.substr(12, 4) == "0F00");
  };
}

TEST_F(MotionTrouble, ADriveThatKeepsItsPowerIsNotGivenItsOldTargetsBack) {
  MotionBench own("sv2", 131072);  // It has no watchdog.
  ASSERT_TRUE(own.session->download(1, objects::kTargetVelocity, {0x40, 0x42, 0x0F, 0}));
  lose_controlwords(*own.bus);
  const auto done = own.jog(jog_for("60rpm", 300ms));
  EXPECT_FALSE(done.end.verified);
  EXPECT_TRUE(own.energised());
  EXPECT_EQ(own.drive().value(objects::kTargetVelocity), (Bytes{0, 0, 0, 0}));
  EXPECT_GE(done.end.left.size(), 3U);
  EXPECT_TRUE(own.session->energised().contains(1));
}

TEST_F(MotionTrouble, ADriveThatKeepsItsPowerIsLeftToItsOwnWatchdog) {
  lose_controlwords(*bench.bus);
  const auto done = bench.jog(jog_for("60rpm", 300ms));
  EXPECT_EQ(done.end.state, DriveState::fault);
  EXPECT_TRUE(done.end.verified);
  EXPECT_FALSE(bench.energised());
  EXPECT_NE(bench.drive().value({0x1016, 1}), bench.before["0x1016:1"]);
  EXPECT_GE(done.end.left.size(), 3U);
}

/// A TPDO that carries statusword and position every 5 ms.
void map_tpdo(MotionBench& bench) {
  const auto write = [&](ObjectAddress object, std::uint64_t value, std::size_t size) {
    ASSERT_TRUE(bench.session->download(1, object, store_le(value, size))) << to_string(object);
  };
  write({0x1800, 1}, 0xC000'0181, 4);
  write({0x1A00, 0}, 0, 1);
  write({0x1A00, 1}, 0x6041'0010, 4);
  write({0x1A00, 2}, 0x6064'0020, 4);
  write({0x1A00, 0}, 2, 1);
  write({0x1800, 2}, 255, 1);
  write({0x1800, 3}, 0, 2);
  write({0x1800, 5}, 5, 2);
  write({0x1800, 1}, 0x4000'0181, 4);
  ASSERT_TRUE(bench.session->can()->send(canopen::nmt_frame(canopen::NmtCommand::start, 1)));
}

TEST_F(MotionTrouble, WhatATpdoBringsIsNotReadBySdo) {
  map_tpdo(bench);
  const auto done = bench.jog(jog_turns("60rpm", 2));
  ASSERT_TRUE(done.outcome) << done.outcome.error().message.text();
  EXPECT_NEAR(*done.samples.back()[Signal::position], 720, 30);
  EXPECT_GT(done.by_pdo, 2 * done.samples.size() * 9 / 10);
  const auto& frames = bench.bus->frames;
  const auto reads = [&](std::string_view object) {
    return std::count_if(frames.begin(), frames.end(),
                         [&](const auto& f) { return f.substr(0, 12) == object; });
  };
  EXPECT_LT(reads("601#40646000"), 10);
  EXPECT_GT(reads("601#406C6000"), 50) << "the velocity is in no TPDO";
}

/// A drive that has gone to another mapping, or whose TPDOs come too seldom, is read as before.
TEST_F(MotionTrouble, ATpdoThatIsOldOrOfAnotherLengthIsNotBelieved) {
  map_tpdo(bench);
  bench.bus->alter = [](can::Frame& frame) {
    if (frame.id == 0x181) frame.size = 8;
  };
  const auto done = bench.jog(jog_for("60rpm", 500ms));
  ASSERT_TRUE(done.outcome) << done.outcome.error().message.text();
  EXPECT_EQ(done.by_pdo, 0U);
}

/// Another master maps something else of the same length while the drive moves.
TEST_F(MotionTrouble, OnceAnotherMasterChangesTheMappingEverythingIsReadBySdo) {
  map_tpdo(bench);
  std::string told;
  bench.session->options().tell = [&](std::string_view line) { told += std::string(line) + "\n"; };
  const auto changed = std::chrono::milliseconds(500);
  std::optional<TimePoint> begin;
  bool written = false;
  bench.bus->alter = [&](can::Frame& frame) {
    if (frame.id != 0x181) return;
    if (!begin && bench.energised()) begin = bench.session->now();
    if (!begin || bench.session->now() < *begin + changed) return;
    if (!std::exchange(written, true)) {
      bench.bus->injected.emplace_back("601#23001A0220006C60");
      return;
    }
    frame.data[0] = 0x08;  // No statusword: fault, to who takes it for one.
    frame.data[1] = 0;
  };
  const auto done = bench.jog(jog_turns("60rpm", 2));
  ASSERT_TRUE(done.outcome) << done.outcome.error().message.text();
  EXPECT_TRUE(written);
  EXPECT_GT(done.by_pdo, 0U);
  EXPECT_NE(
      told.find("node 1 has another PDO setting: object 0x1A00:2 was written: its values are read by SDO"),
      std::string::npos)
      << told;
}

TEST_F(MotionTrouble, AShortMoveIsDoneWhenTheMotorIsThereAndNotBefore) {
  MotionBench own("dm", 0);
  const auto done = own.move(move_to("0.4deg", "30rpm", true));
  ASSERT_TRUE(done.outcome) << done.outcome.error().message.text();
  EXPECT_NEAR(*done.samples.back()[Signal::position], 0.4, 0.05);
}

TEST_F(MotionTrouble, BothHomingSpeedsAreBoundByTheLimit) {
  bench.obey_switches();
  auto home = home_by("1");
  home.slow = "3000rpm";
  const auto done = bench.home(home);
  ASSERT_FALSE(done.outcome);
  EXPECT_EQ(done.outcome.error().code, Errc::refused);
  EXPECT_NE(done.outcome.error().message.text().find("3000 rpm is above the limit"), std::string::npos);
}

TEST_F(MotionTrouble, ANewZeroIsNoWay) {
  bench.obey_switches();
  ASSERT_TRUE(bench.move(move_to("3rev", "250rpm")).outcome);
  bench.drive().track().negative_limit.to = 2;  // A turn from where it stands, so it stays in the window.
  bench.options.window = "2.5rev";
  const auto done = bench.home(home_by("1"));
  EXPECT_TRUE(done.outcome) << done.outcome.error().message.text();
}

TEST_F(MotionTrouble, AnAccelerationThatIsNoneIsToldBeforeAnythingIsTouched) {
  bench.options.acceleration = "banana";
  const auto done = bench.jog(kJog);
  ASSERT_FALSE(done.outcome);
  EXPECT_FALSE(done.begun);
}

}  // namespace
}  // namespace servoctl::motion
