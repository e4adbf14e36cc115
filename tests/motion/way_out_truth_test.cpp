// Links that are lost, drives that refuse, ignore and lie, other masters: they are stopped, and the end tells
// what was seen.
#include <algorithm>
#include <new>
#include <stdexcept>

#include "way_out_support.hpp"

namespace servoctl::motion {
namespace {

using namespace std::chrono_literals;
using drive::DriveState;

class WayOutInTrouble : public WayOut {};

/// The link: down for a moment, and for longer than a person waits.
TEST_P(WayOutInTrouble, ALinkThatWasDownIsUsedToStopAsSoonAsItIsBack) {
  for (const auto length : {Duration(20ms), Duration(9s)}) {
    MotionBench bench(family(), GetParam().turn);
    std::vector<std::string> told;
    bench.session->options().tell = [&](std::string_view line) { told.emplace_back(line); };
    bench.started = [&] {
      bench.bus->outage.from = bench.session->now() + 700ms;
      bench.bus->outage.to = bench.bus->outage.from + length;
    };
    const auto done = bench.jog(jog_for("60rpm", 5s));
    ASSERT_FALSE(done.outcome);
    EXPECT_EQ(done.outcome.error().code, Errc::bus);
    EXPECT_TRUE(done.end.verified);
    EXPECT_FALSE(bench.energised());
    EXPECT_EQ(load_le(bench.drive().value(objects::kControlword)), 0U);
    EXPECT_EQ(bench.changed(), std::vector<std::string>{});
    EXPECT_GE(told.size(), length < 1s ? 2U : 10U);
    ASSERT_FALSE(told.empty());
    EXPECT_NE(told.front().find("stopping node 1 waits for the bus"), std::string::npos) << told.front();
    // What was away for less than ten milliseconds more was not seen to be away.
    EXPECT_NE(told.back().find(length < 1s ? "now stopping node 1" : "is back after"), std::string::npos)
        << told.back();
  }
}

TEST_P(WayOutInTrouble, ALinkThatStaysDownIsWaitedForAndTold) {
  MotionBench bench(family(), GetParam().turn);
  bench.started = [&] {
    bench.bus->outage.from = bench.session->now() + 700ms;
    bench.bus->outage.to = bench.bus->outage.from + 1h;
  };
  const auto done = bench.jog(jog_for("60rpm", 5s));
  ASSERT_FALSE(done.outcome);
  EXPECT_FALSE(done.end.verified);
  EXPECT_GE(bench.session->now() - bench.bus->outage.from, 10s);
  EXPECT_TRUE(bench.session->energised().contains(1));
}

TEST_P(WayOutInTrouble, DrivesThatWereLeftEnergisedAreStoppedOverALinkThatComesBack) {
  Several all(family(), 3);
  all.bus->outage.from = all.session->now();
  all.bus->outage.to = all.session->now() + 2s;
  for (const auto& [node, outcome, fault] : de_energise(*all.session)) EXPECT_TRUE(outcome) << int{node};
  for (const auto node : all.nodes) EXPECT_EQ(all.drive(node).power_state(), DriveState::switch_on_disabled);
}

/// CiA 301, table 39: a node that is stopped answers no SDO.
TEST_P(WayOutInTrouble, ANodeThatAnotherMasterHasStoppedIsWokenUpToBeDisabled) {
  MotionBench bench(family(), GetParam().turn);
  int samples = 0;
  bench.options.on_sample = [&](const MotionSample&) {
    if (++samples == 10) (void)bench.bus->bus.send(canopen::nmt_frame(canopen::NmtCommand::stop, 1));
  };
  const auto done = bench.jog(jog_for("60rpm", 3s));
  ASSERT_FALSE(done.outcome);
  EXPECT_TRUE(done.end.verified) << done.outcome.error().message.text();
  EXPECT_FALSE(bench.energised());
  EXPECT_EQ(load_le(bench.drive().value(objects::kControlword)), 0U);
}

TEST_P(WayOutInTrouble, AnErrorThatIsNoLossDoesNotEndTheStopping) {
  MotionBench bench(family(), GetParam().turn);
  int samples = 0;
  bench.options.on_sample = [&](const MotionSample&) {
    if (++samples == 10) bench.drive().misbehaviour().missing = {0x6041};
  };
  const auto done = bench.jog(jog_for("60rpm", 3s));
  ASSERT_FALSE(done.outcome);
  EXPECT_FALSE(bench.energised());
  EXPECT_FALSE(done.end.verified) << "it was not seen";
}

TEST_P(WayOutInTrouble, ADriveThatIgnoresTheWordsIsToldAlsoWhenItTripsLater) {
  MotionBench bench(family(), GetParam().turn);
  bench.drive().misbehaviour().ignores_disable = true;
  const auto done = bench.jog(jog_for("60rpm", 300ms));
  EXPECT_FALSE(done.end.left.empty());
  EXPECT_EQ(done.end.verified, !bench.energised());
}

/// Without power by itself (STO), and 6040h keeps what starts it again although the writes were acknowledged.
TEST_P(WayOutInTrouble, AWordThatIsAcknowledgedAndNotTakenIsNoEnd) {
  MotionBench bench(family(), GetParam().turn);
  int samples = 0;
  bench.options.on_sample = [&](const MotionSample&) {
    if (++samples != 10) return;
    bench.drive().set_torque_off(true);
    bench.drive().misbehaviour().feigned = {0x6040};
  };
  const auto done = bench.jog(jog_for("60rpm", 3s));
  ASSERT_FALSE(done.end.left.empty());
  EXPECT_NE(done.end.left.front().find(
                "6040h did not accept 0000h (the write was acknowledged, but it still reads 0x"),
            std::string::npos)
      << done.end.left.front();
}

TEST_P(WayOutInTrouble, AQuickStopThatIsAcknowledgedAndNotTakenIsNoEnd) {
  for (const bool feigns : {true, false}) {
    Several one(family(), 1);
    one.drive(1).set_torque_off(true);
    if (feigns) one.drive(1).misbehaviour().feigned = {0x6040};
    const auto done = one.take_down(PowerAim::stop).front();
    EXPECT_EQ(done.outcome.has_value(), !feigns);
    if (feigns) {
      EXPECT_NE(
          done.outcome.error().message.text().find("6040h did not accept 0002h (the write was acknowledged"),
          std::string::npos)
          << done.outcome.error().message.text();
    }
  }
}

/// What 6040h holds cannot be known then: the acknowledge is all there is.
TEST_P(WayOutInTrouble, AControlwordThatCannotBeReadIsTakenForWhatWasAcknowledged) {
  Several one(family(), 1);
  one.drive(1).misbehaviour().unreadable = {0x6040};
  const auto done = one.take_down(PowerAim::disable).front();
  EXPECT_TRUE(done.outcome);
  EXPECT_TRUE(done.is_without_power());
}

TEST_P(WayOutInTrouble, SwitchedOnIsNotWithoutPower) {
  MotionBench bench(family(), GetParam().turn);
  bench.drive().misbehaviour().stays_switched_on = true;
  const auto done = bench.jog(jog_for("60rpm", 300ms));
  ASSERT_FALSE(done.end.left.empty());
  EXPECT_NE(done.end.left.front().find("did not obey 0000h"), std::string::npos) << done.end.left.front();
  EXPECT_EQ(done.end.verified, bench.drive().power_state() != DriveState::switched_on);
  Several one(family(), 1);
  one.drive(1).misbehaviour().stays_switched_on = true;
  const auto disabled = Power(*one.session, *one.bus->cell.profiles.front(), 1).disable();
  EXPECT_EQ(disabled.has_value(), is_without_power(one.drive(1).power_state()));
}

TEST_P(WayOutInTrouble, AnObjectThatOnlySeemsToBePutBackIsTold) {
  MotionBench bench(family(), GetParam().turn);
  int samples = 0;
  bench.options.on_sample = [&](const MotionSample&) {
    if (++samples == 5) bench.drive().misbehaviour().feigned = {0x6060};
  };
  ASSERT_TRUE(bench.drive().value(objects::kModeOfOperation) !=
              store_le(static_cast<std::uint64_t>(*bench.profile().rules.motion.velocity),
                       bench.drive().value(objects::kModeOfOperation).size()));
  const auto done = bench.jog(jog_for("60rpm", 300ms));
  EXPECT_TRUE(done.end.verified);
  // That no mode is chosen any more is nothing to put back.
  const bool none_chosen = load_le(bench.before["0x6060:0"]) == 0;
  const auto& told = none_chosen ? done.end.notes : done.end.left;
  ASSERT_EQ(told.size(), 1U);
  EXPECT_NE(told.front().find(none_chosen ? "6060h was 0" : "0x6060:0 could not be restored"),
            std::string::npos);
}

/// Two motions at once: each keeps what the other has set, and puts that back.
TEST_P(WayOutInTrouble, WhatAnotherMasterWritesMeanwhileIsTold) {
  MotionBench bench(family(), GetParam().turn);
  int samples = 0;
  bench.options.on_sample = [&](const MotionSample&) {
    if (++samples == 5) bench.bus->injected.emplace_back("601#2F60600001000000");
  };
  const auto done = bench.jog(jog_for("60rpm", 300ms));
  ASSERT_EQ(done.end.left.size(), 1U);
  EXPECT_NE(done.end.left.front().find("another master wrote object 0x6060:0"), std::string::npos);
}

TEST_P(WayOutInTrouble, MemoryThatRunsOutInMidMotionEndsItAndTheEndIsTold) {
  MotionBench bench(family(), GetParam().turn);
  int samples = 0;
  bench.options.on_sample = [&](const MotionSample&) {
    if (++samples == 10) throw std::bad_alloc();
  };
  const auto done = bench.jog(jog_for("60rpm", 3s));
  ASSERT_FALSE(done.outcome);
  EXPECT_EQ(done.outcome.error().code, Errc::bug);
  EXPECT_NE(done.outcome.error().message.text().find("out of memory"), std::string::npos);
  EXPECT_TRUE(done.end.verified);
  EXPECT_FALSE(bench.energised());
  EXPECT_EQ(bench.changed(), std::vector<std::string>{});
}

/// A way out that cannot even say what it does.
TEST_P(WayOutInTrouble, AnExceptionInTheWayOutItselfStillStopsTheDrive) {
  MotionBench bench(family(), GetParam().turn);
  int samples = 0;
  bench.options.on_sample = [&](const MotionSample&) {
    if (++samples != 10) return;
    int left = 1;
    bench.bus->on_sent = [left](const can::Frame&) mutable {
      if (left-- > 0) throw std::bad_alloc();
    };
    throw std::runtime_error("a bug");
  };
  EXPECT_THROW((void)bench.jog(jog_for("60rpm", 3s)), std::runtime_error);
  EXPECT_FALSE(bench.energised());
}

INSTANTIATE_TEST_SUITE_P(Families, WayOutInTrouble, testing::ValuesIn(kEnabledFamilies), name_of);

}  // namespace
}  // namespace servoctl::motion
