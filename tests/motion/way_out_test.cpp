// The way out of several drives at once, and of those that lose their power by themselves.
#include <algorithm>

#include "way_out_support.hpp"

namespace servoctl::motion {
namespace {

using namespace std::chrono_literals;
using drive::DriveState;

constexpr PowerAim kAims[] = {PowerAim::stop, PowerAim::disable, PowerAim::stop_and_disable};

class WayOutOfFamily : public WayOut {};

TEST_P(WayOutOfFamily, TheStopWordGoesToAllBeforeAnyAnswerIsWaitedFor) {
  for (const auto aim : kAims) {
    Several all(family(), 8);
    std::vector<TimePoint> times;
    all.bus->on_sent = [&](const can::Frame&) { times.push_back(all.bus->now()); };
    const auto done = all.take_down(aim);
    ASSERT_GE(all.bus->frames.size(), 8U);
    for (std::size_t i = 0; i < 8; ++i) {
      const auto word = aim == PowerAim::disable ? "07" : "02";
      EXPECT_EQ(all.bus->frames[i], "60" + std::to_string(i + 1) + "#2B406000" + word + "000000");
      EXPECT_EQ(times[i], all.begun);
    }
    for (const auto& one : done) EXPECT_TRUE(one.outcome) << one.outcome.error().message.text();
    if (aim != PowerAim::stop)
      for (const auto node : all.nodes) {
        EXPECT_EQ(all.drive(node).power_state(), DriveState::switch_on_disabled);
        EXPECT_EQ(load_le(all.drive(node).value(objects::kControlword)), 0U);
      }
  }
}

/// What `-n all` goes to: numbers of which nobody knows whether there is a drive.
TEST_P(WayOutOfFamily, WhatMayBeAbsentIsWokenAtOnceAndDelaysNone) {
  Several all(family(), 3);
  ASSERT_TRUE(all.session->can()->send(canopen::nmt_frame(canopen::NmtCommand::stop, 2)));
  std::vector<PowerDownPlan> plans;
  for (const auto node : {1, 2, 3, 4, 5}) {
    plans.emplace_back();
    plans.back().node = static_cast<std::uint8_t>(node);
    plans.back().aim = PowerAim::disable;
    plans.back().may_be_absent = true;
  }
  const auto begun = all.session->now();
  const auto done = take_down(*all.session, plans);
  for (const auto i : {0U, 1U, 2U}) EXPECT_TRUE(done[i].is_without_power() && !done[i].silent) << i;
  for (const auto i : {3U, 4U}) EXPECT_TRUE(done[i].silent) << i;
  const auto woken = std::count_if(all.bus->frames.begin(), all.bus->frames.end(), [](const auto& frame) {
    return frame == "000#8004" || frame == "000#8005";
  });
  EXPECT_EQ(woken, 2);
  EXPECT_LE(all.session->now() - begun, 2 * all.session->options().timeout + std::chrono::milliseconds(700));
}

TEST_P(WayOutOfFamily, EightDrivesTakeAsLongAsOneAndADeadOneDelaysNone) {
  for (const auto aim : kAims) {
    Several one(family(), 1);
    (void)one.take_down(aim);
    Several eight(family(), 8);
    (void)eight.take_down(aim);
    EXPECT_LE(eight.took, one.took * 13 / 10);
    Several hurt(family(), 8);
    hurt.drive(4).wire_faults().silent = true;
    auto last = hurt.session->now();
    hurt.bus->on_sent = [&](const can::Frame& frame) {
      if (frame.id != 0x604 && frame.id != 0) last = hurt.bus->now();
    };
    const auto done = hurt.take_down(aim);
    EXPECT_LE(last - hurt.begun, one.took * 13 / 10);
    for (std::size_t i = 0; i < done.size(); ++i) EXPECT_EQ(done[i].outcome.has_value(), i != 3) << i;
    EXPECT_EQ(done[3].outcome.error().code, Errc::timeout);
    EXPECT_FALSE(done[3].statusword) << "nothing was seen of it";
  }
}

TEST_P(WayOutOfFamily, WhatWasLeftEnergisedIsTakenDownTogetherAndTheDeadOneIsTold) {
  Several all(family(), 8);
  all.drive(2).wire_faults().silent = true;
  const auto done = de_energise(*all.session);
  ASSERT_EQ(done.size(), 8U);
  for (const auto& [node, outcome, fault] : done) EXPECT_EQ(outcome.has_value(), node != 2) << int{node};
  EXPECT_EQ(all.session->energised().nodes(), std::set<std::uint8_t>{2});
}

/// A drive that has lost its power by itself starts again with what 6040h holds.
TEST_P(WayOutOfFamily, ADriveWhoseEnableInputGoesOffInMidMotionDoesNotStartAgainByItself) {
  MotionBench bench(family(), GetParam().turn);
  int samples = 0;
  bench.options.on_sample = [&](const MotionSample&) {
    if (++samples == 10) bench.drive().set_torque_off(true);
  };
  const auto done = bench.jog(jog_for("60rpm", 3s));
  EXPECT_FALSE(done.outcome);
  EXPECT_TRUE(done.end.verified);
  EXPECT_EQ(done.end.left, std::vector<std::string>{});
  EXPECT_EQ(load_le(bench.drive().value(objects::kControlword)), 0U);
  bench.drive().set_torque_off(false);
  bench.wait(100ms);
  EXPECT_FALSE(bench.energised());
}

TEST_P(WayOutOfFamily, NeitherDoesOneThatIsDisabledOrWasLeftEnergised) {
  for (const bool by_command : {true, false}) {
    Several one(family(), 1);
    one.drive(1).set_torque_off(true);
    // Whoever looks at it meanwhile does not make it forgotten.
    (void)Power(*one.session, *one.bus->cell.profiles.front(), 1).state();
    EXPECT_TRUE(one.session->energised().contains(1));
    if (by_command) {
      EXPECT_TRUE(Power(*one.session, *one.bus->cell.profiles.front(), 1).disable());
    } else {
      EXPECT_EQ(de_energise(*one.session).size(), 1U);
    }
    one.drive(1).set_torque_off(false);
    EXPECT_EQ(one.drive(1).power_state(), DriveState::switch_on_disabled);
    EXPECT_TRUE(one.session->energised().empty());
  }
}

TEST_P(WayOutOfFamily, ADriveInFaultIsGivenTheWordsAsWell) {
  Several one(family(), 1);
  one.drive(1).raise_fault(0x2310, {}, one.session->now());
  (void)one.session->wait([] { return false; }, one.session->now() + 50ms);
  const auto done = one.take_down(PowerAim::disable);
  ASSERT_TRUE(done.front().outcome);
  EXPECT_EQ(done.front().state(), DriveState::fault);
  EXPECT_EQ(load_le(one.drive(1).value(objects::kControlword)), 0U);
}

TEST_P(WayOutOfFamily, AWordThatCannotBeWrittenIsToldAlsoWithoutPower) {
  MotionBench bench(family(), GetParam().turn);
  int samples = 0;
  bench.options.on_sample = [&](const MotionSample&) {
    if (++samples != 10) return;
    bench.drive().set_torque_off(true);
    bench.drive().misbehaviour().refused = {0x6040};
  };
  const auto done = bench.jog(jog_for("60rpm", 3s));
  ASSERT_EQ(done.end.left.size(), 1U);
  EXPECT_NE(done.end.left.front().find("6040h did not accept 0000h"), std::string::npos)
      << done.end.left.front();
}

INSTANTIATE_TEST_SUITE_P(Families, WayOutOfFamily, testing::ValuesIn(kEnabledFamilies), name_of);

}  // namespace
}  // namespace servoctl::motion
