// A verdict comes from what was measured: way, time, speed by two sources, the mode, and the state at the
// end.
#include "motion_support.hpp"

namespace servoctl::motion {
namespace {

using namespace std::chrono_literals;

/// Changes what the drive tells of an object in 4 bytes.
void tell(MotionBus& bus, std::uint16_t index, std::function<double(double)> change) {
  bus.alter = [index, change = std::move(change)](can::Frame& frame) {
    if (frame.id != 0x581 || load_le(std::span(frame.data).subspan(1, 2)) != index) return;
    const auto value = static_cast<std::int32_t>(load_le(std::span(frame.data).subspan(4, 4)));
    store_le(static_cast<std::uint64_t>(static_cast<std::int64_t>(change(value))),
             std::span(frame.data).subspan(4, 4));
  };
}

class MeasuredTruth : public testing::Test {
 protected:
  void expect_ended(const MotionReport& done, std::string_view reason) {
    ASSERT_FALSE(done.outcome);
    EXPECT_NE(done.outcome.error().message.text().find(reason), std::string::npos)
        << done.outcome.error().message.text();
    EXPECT_FALSE(bench.energised());
  }
  Duration length(const MotionReport& done) { return done.samples.back().time - done.samples.front().time; }
  /// Does something once so many samples were taken.
  void at_sample(int number, std::function<void()> what) {
    bench.options.on_sample = [this, number, what = std::move(what)](const MotionSample&) {
      if (++samples_ == number) what();
    };
  }

  MotionBench bench{"ts", 10000};  // Its window for the following error is 0: no fault by itself.

 private:
  int samples_ = 0;
};

TEST_F(MeasuredTruth, AMotorThatNeverMovesIsNotDoneHoweverShortTheJog) {
  bench.drive().axis_faults().stalled = true;
  for (const auto time : {100ms, 300ms, 1000ms}) {
    const auto done = bench.jog(jog_for("60rpm", time));
    EXPECT_FALSE(done.outcome && done.differences.empty()) << time.count();
  }
}

TEST_F(MeasuredTruth, AJogAsShortAsItsRampIsDone) {
  for (const auto time : {100ms, 300ms, 1000ms}) {
    const auto done = bench.jog(jog_for("-60rpm", time));
    ASSERT_TRUE(done.outcome) << done.outcome.error().message.text();
    EXPECT_EQ(done.differences, std::vector<std::string>{}) << time.count();
  }
}

TEST_F(MeasuredTruth, AFrozenPositionEndsAJog) {
  tell(*bench.bus, 0x6064, [](double) { return 1234; });
  const auto done = bench.jog(jog_for("60rpm", 10s));
  expect_ended(done, "its position (6064h) changes by 0 rpm");
  EXPECT_LT(length(done), 1s);
}

TEST_F(MeasuredTruth, AReversedPositionEndsAJog) {
  tell(*bench.bus, 0x6064, [](double v) { return -v; });
  const auto done = bench.jog(jog_for("60rpm", 10s));
  expect_ended(done, "its position (6064h) changes by -");
  EXPECT_LT(length(done), 1s);
}

TEST_F(MeasuredTruth, ATurnThatIsNotTheMotorsEndsAJog) {
  bench.options.turn = 1000;  // 606Ch is in rpm, whatever the counts are.
  const auto done = bench.jog(jog_for("60rpm", 10s));
  expect_ended(done, "by its position (6064h)");
  EXPECT_LT(length(done), 1s);
}

TEST_F(MeasuredTruth, ASpeedThatIsNeverToldEndsATorque) {
  bench.options.speed_limit = "60rpm";
  tell(*bench.bus, 0x606C, [](double) { return 0; });
  const auto done = bench.torque({.torque = "20%", .length = 3s});
  expect_ended(done, "(6064h)");
  EXPECT_LT(length(done), 1s);
}

TEST_F(MeasuredTruth, AGapInTheLooksEndsTheMotion) {
  at_sample(20, [&] { bench.wait(4s); });
  const auto done = bench.jog(jog_for("60rpm", 2s));
  expect_ended(done, "was not looked at for 1.");
}

TEST_F(MeasuredTruth, AModeThatIsLeftEndsTheMotion) {
  at_sample(20, [&] { tell(*bench.bus, 0x6061, [](double) { return 8; }); });
  const auto done = bench.jog(jog_for("60rpm", 5s));
  expect_ended(done, "6061h shows 8 instead of 3");
  EXPECT_LT(length(done), 1s);
}

TEST_F(MeasuredTruth, AJogOverASlowLinkEndsInTimeOrIsNotDone) {
  bench.drive().wire_faults().answer_delay = 150ms;
  const auto begin = bench.session->now();
  TimePoint stopped{};
  bench.bus->on_sent = [&](const can::Frame& frame) {
    if (can::to_string(frame) == "601#23FF600000000000") stopped = bench.session->now();
  };
  const auto done = bench.jog(jog_for("60rpm", 4s));
  EXPECT_TRUE(!done.outcome || !done.differences.empty() || stopped - begin < 30s);
  EXPECT_FALSE(bench.energised());
  if (!done.outcome) return;
  const auto way = done.samples.back()[Signal::position].value_or(0);
  EXPECT_TRUE(!done.differences.empty() || std::abs(way - 1440) < 300) << way;
}

TEST_F(MeasuredTruth, ADriveInFaultAtTheEndIsNotDone) {
  bench.bus->on_sent = [&](const can::Frame& frame) {
    if (can::to_string(frame) == "601#2B40600007000000")
      bench.drive().raise_fault(0x2310, {}, bench.session->now());
  };
  const auto done = bench.jog(jog_for("60rpm", 1s));
  ASSERT_EQ(done.end.state, drive::DriveState::fault);
  expect_ended(done, "fault");
}

TEST_F(MeasuredTruth, ADriveThatAnotherMasterCommandsIsNotEnabled) {
  int enables = 0;
  bench.bus->on_sent = [&](const can::Frame& frame) {
    const auto text = can::to_string(frame);
    if (text == "601#40FF600000000000") bench.bus->injected.emplace_back("601#23FF600010270000");
    enables += text == "601#2B4060000F000000";
  };
  const auto done = bench.jog(jog_for("60rpm", 1s));
  ASSERT_FALSE(done.outcome);
  EXPECT_NE(done.outcome.error().message.text().find(
                "another master has written object 0x60FF:0: the drive was not enabled"),
            std::string::npos)
      << done.outcome.error().message.text();
  EXPECT_EQ(enables, 0);
}

TEST_F(MeasuredTruth, WhatAnotherMasterWritesEndsMovesAndTorques) {
  at_sample(5, [&] { bench.bus->injected.emplace_back("601#23FF600010270000"); });
  const auto moved = bench.move(move_to("5rev", "60rpm"));
  expect_ended(moved, "another master wrote object 0x60FF:0");
  MotionBench own("cia402", 10000);
  own.options.speed_limit = "200rpm";
  int samples = 0;
  own.options.on_sample = [&](const MotionSample&) {
    if (++samples == 3) own.bus->injected.emplace_back("601#237A600010270000");
  };
  const auto pushed = own.torque({.torque = "1%", .length = 1s});
  ASSERT_FALSE(pushed.outcome);
  EXPECT_NE(pushed.outcome.error().message.text().find("another master wrote object 0x607A:0"),
            std::string::npos)
      << pushed.outcome.error().message.text();
}

/// By which targets may come that nobody has seen.
TEST_F(MeasuredTruth, AnRpdoThatAnotherMasterMapsEndsTheMotion) {
  at_sample(5, [&] { bench.bus->injected.emplace_back("601#2300160120006040"); });
  expect_ended(bench.move(move_to("5rev", "60rpm")), "another master wrote object 0x1600:1");
}

TEST_F(MeasuredTruth, AModeThatCannotGoBackToNoneIsANote) {
  MotionBench own("cia402", 10000);
  ASSERT_EQ(load_le(own.drive().value(objects::kModeOfOperation)), 0U);
  int samples = 0;
  own.options.on_sample = [&](const MotionSample&) {
    if (++samples == 5) own.drive().misbehaviour().refused = {0x6060};
  };
  const auto done = own.jog(jog_for("60rpm", 1s));
  ASSERT_TRUE(done.outcome) << done.outcome.error().message.text();
  EXPECT_EQ(done.end.left, std::vector<std::string>{});
  ASSERT_EQ(done.end.notes.size(), 1U);
  EXPECT_NE(done.end.notes.front().find("6060h was 0"), std::string::npos);
}

TEST(FloatTarget, SoFarThatItsStepsAreTooGreatIsRefused) {
  MotionBench bench("dm");
  const auto done = bench.move(move_to("1e30deg", "60rpm"));
  ASSERT_FALSE(done.outcome);
  EXPECT_EQ(done.outcome.error().code, Errc::usage);
  EXPECT_NE(done.outcome.error().message.text().find("is too far"), std::string::npos)
      << done.outcome.error().message.text();
  EXPECT_FALSE(done.begun);
}

/// Homing of a drive whose statusword says "attained" all the time.
class StuckAttained : public testing::Test {
 protected:
  StuckAttained() {
    bench.bus->alter = [](can::Frame& frame) {
      if (frame.id == 0x581 && load_le(std::span(frame.data).subspan(1, 2)) == 0x6041)
        frame.data[5] = static_cast<std::uint8_t>(frame.data[5] | 0x14U);
    };
    bench.obey_switches();
  }
  MotionBench bench{"gsd600", 131072};
};

TEST_F(StuckAttained, HasBegunWhereTheMotorMovesAndEndsWhereItStays) {
  const auto done = bench.home(home_by("17"));
  ASSERT_TRUE(done.outcome) << done.outcome.error().message.text();
  ASSERT_EQ(done.unchecked.size(), 1U);
  EXPECT_NE(done.unchecked.front().find("was set all the time"), std::string::npos);
}

TEST_F(StuckAttained, HasNotBegunWhereTheMotorStands) {
  bench.drive().axis_faults().late_start = 1h;
  const auto done = bench.home(home_by("17"));
  ASSERT_FALSE(done.outcome);
  EXPECT_NE(done.outcome.error().message.text().find("does not start homing"), std::string::npos);
}

}  // namespace
}  // namespace servoctl::motion
