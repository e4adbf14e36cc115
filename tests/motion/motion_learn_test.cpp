// How many counts a turn of the motor has is measured, or it is refused; and a number that was measured once
// is watched while it is used.
#include "learn_bench.hpp"

namespace servoctl::motion {
namespace {

using namespace std::chrono_literals;

void expect_refused(LearnBench& bench, const LearnReport& done, std::string_view why) {
  ASSERT_FALSE(done.motion.outcome);
  EXPECT_NE(done.motion.outcome.error().message.text().find(why), std::string::npos)
      << done.motion.outcome.error().message.text();
  EXPECT_FALSE(done.counts);
  EXPECT_FALSE(bench.energised());
  if (!done.motion.begun) return;
  EXPECT_TRUE(done.motion.end.verified);
  EXPECT_EQ(bench.changed(), std::vector<std::string>{});
}

TEST(Learn, FindsEveryPowerOfTwoWithoutKnowingItsSize) {
  for (const int bits : {15, 17, 20, 23, 24}) {
    SCOPED_TRACE(bits);
    LearnBench bench(std::ldexp(1, bits));
    const auto done = bench.learn();
    ASSERT_TRUE(done.motion.outcome) << done.motion.outcome.error().message.text();
    ASSERT_TRUE(done.counts);
    EXPECT_EQ(done.counts->counts, std::ldexp(1, bits));
    EXPECT_NE(done.counts->reason.find("2^" + std::to_string(bits)), std::string::npos)
        << done.counts->reason;
    EXPECT_LT(done.measured->uncertainty, 0.01);
    EXPECT_NEAR(done.measured->increments, std::ldexp(1, bits), std::ldexp(0.004, bits));
    EXPECT_NEAR(done.measured->rpm, 30, 3);
    EXPECT_TRUE(done.motion.end.verified);
    EXPECT_EQ(bench.changed(), std::vector<std::string>{});
    EXPECT_LE(bench.fastest(), std::ldexp(33, bits) / 60);
  }
}

TEST(Learn, TurnsTheOtherWayWhereThatIsAsked) {
  LearnBench bench(131072);
  bench.how.rpm = -20;
  const auto done = bench.learn();
  ASSERT_TRUE(done.motion.outcome) << done.motion.outcome.error().message.text();
  EXPECT_EQ(done.counts->counts, 131072);
  EXPECT_LT(done.motion.series.front().values.back(), 0);
}

TEST(Learn, TakesTheGearOut) {
  LearnBench bench(8388608);
  ASSERT_TRUE(bench.session->download(1, {0x6091, 1}, store_le(2, 4)));
  const auto done = bench.learn();
  ASSERT_TRUE(done.motion.outcome) << done.motion.outcome.error().message.text();
  EXPECT_EQ(done.counts->counts, 8388608);
  EXPECT_NEAR(done.measured->increments, 4194304, 4194304 * 0.004);
}

TEST(Learn, TakesADecimalNumberOnlyWhereTheScaleOfTheMonitorIsCertainOrSomebodyKnowsIt) {
  LearnBench certain(100000);
  const auto taken = certain.learn();
  ASSERT_TRUE(taken.motion.outcome) << taken.motion.outcome.error().message.text();
  EXPECT_EQ(taken.counts->counts, 100000);

  LearnBench disputed(100000);
  disputed.how.expected.disputed = true;
  expect_refused(disputed, disputed.learn(), "100000 is near, but the manual gives two scales");

  LearnBench told(100000);
  told.how.expected = {100000, true};
  EXPECT_EQ(told.learn().counts->counts, 100000);

  LearnBench other(100000);
  other.how.expected = {131072, true};
  expect_refused(other, other.learn(), "not the 131072 of --nameplate");
}

TEST(Learn, RefusesANumberThatIsNoneOfThese) {
  LearnBench bench(70000);
  expect_refused(bench, bench.learn(), "neither a power of two nor a round decimal number");
}

TEST(Learn, NeverGoesFasterThanIsSafeWhileTheMonitorShowsNothing) {
  LearnBench bench(32768);
  bench.lie([](double) { return 0.; });
  expect_refused(bench, bench.learn(), "Pn1002 shows 0 rpm: not usable");
  EXPECT_LE(bench.fastest(), 300. * 32768 / 60);
}

TEST(Learn, RefusesAMonitorThatDoesNotGoWithTheSpeeds) {
  LearnBench bench(8388608);
  bench.lie([](double raw) { return raw == 0 ? 0 : 100; });
  expect_refused(bench, bench.learn(), "which contradicts its values at other speeds");
}

TEST(Learn, RefusesAMonitorThatWavers) {
  LearnBench bench(131072);
  int look = 0;
  bench.lie([&look](double raw) { return raw * (++look < 90 ? 1 : look / 40 % 2 == 0 ? 0.75 : 1.2); });
  expect_refused(bench, bench.learn(), "a speed that does not match its position");
}

TEST(Learn, ToleratesTheNoiseOfAMonitor) {
  LearnBench bench(8388608);
  std::uint32_t seed = 1;
  bench.lie([&seed](double raw) {
    seed = seed * 1664525 + 1013904223;
    return raw == 0 ? 0 : raw + (static_cast<double>(seed >> 16U) / 65536 - 0.5) * 20;  // ±1 rpm
  });
  const auto done = bench.learn();
  ASSERT_TRUE(done.motion.outcome) << done.motion.outcome.error().message.text();
  EXPECT_EQ(done.counts->counts, 8388608);
}

TEST(Learn, RefusesAMonitorThatShowsASpeedAtRest) {
  LearnBench bench(131072);
  bench.lie([](double) { return 300.; });
  const auto done = bench.learn();
  expect_refused(bench, done, "is not energised, but Pn1002 shows 30 rpm");
  EXPECT_FALSE(done.motion.begun);
}

TEST(Learn, StopsAtOnceWhenTheMotorTurnsFasterThanWanted) {
  LearnBench bench(4096);
  expect_refused(bench, bench.learn(), "turns too fast");
}

TEST(Learn, NoticesAMotorThatDoesNotTurn) {
  LearnBench bench(131072);
  bench.drive().axis_faults().stalled = true;
  expect_refused(bench, bench.learn(), "does not turn although commanded to");
}

TEST(Learn, LeavesTheDriveWithoutPowerWhenItIsInterruptedAnywhere) {
  LearnBench whole(8388608);
  ASSERT_TRUE(whole.learn().motion.outcome);
  const int frames = whole.bus->sent;
  for (int at = 60; at < frames; at += frames / 12) {
    SCOPED_TRACE(at);
    LearnBench bench(8388608);
    bench.session->options().cancelled = [&] { return bench.bus->sent >= at; };
    const auto done = bench.learn();
    EXPECT_FALSE(done.counts);
    EXPECT_FALSE(bench.energised());
    if (done.motion.begun && !done.motion.outcome) {
      EXPECT_EQ(done.motion.outcome.error().code, Errc::interrupted);
      EXPECT_TRUE(done.motion.end.verified);
    }
  }
}

TEST(Learn, HasNothingToMeasureWhereTheParametersTell) {
  LearnBench bench(8388608);
  ASSERT_TRUE(bench.session->download(1, kMode, store_le(1, 2)));
  EXPECT_FALSE(bench.learn().motion.outcome);
  bench.options.learned = 8388608;
  MotionUnits units(*bench.session, bench.profile(), 1, {}, {}, 8388608);
  EXPECT_EQ(units.turn(), 131072);
  EXPECT_FALSE(units.uses_learned());
}

TEST(Learn, UsesAKeptNumberWithTheGearOfNow) {
  LearnBench bench(8388608);
  ASSERT_TRUE(bench.session->download(1, {0x6091, 1}, store_le(4, 4)));
  MotionUnits units(*bench.session, bench.profile(), 1, {}, {}, 8388608);
  EXPECT_EQ(units.turn(), 2097152);
  EXPECT_TRUE(units.uses_learned());
  MotionUnits told(*bench.session, bench.profile(), 1, 131072, {}, 8388608);
  EXPECT_EQ(told.turn(), 131072);
  EXPECT_FALSE(told.uses_learned());
}

TEST(Learn, StopsAMotionWhoseKeptNumberIsThatOfAnotherMotor) {
  LearnBench bench(131072);
  bench.options.learned = 8388608;
  const auto done = bench.jog(jog_for("60rpm", 5s));
  ASSERT_FALSE(done.outcome);
  EXPECT_NE(done.outcome.error().message.text().find("by the kept counts per rev"), std::string::npos)
      << done.outcome.error().message.text();
  EXPECT_FALSE(bench.energised());
  EXPECT_LT(done.series.front().values.back(), 360);

  LearnBench right(8388608);
  right.options.learned = 8388608;
  EXPECT_TRUE(right.jog(jog_for("60rpm", 2s)).outcome);
  const auto moved = right.move(move_to("720deg", "60rpm", true));
  EXPECT_TRUE(moved.outcome) << moved.outcome.error().message.text();
}

TEST(Learn, StopsAMotionWhoseParametersAreSetAndNotInForce) {
  for (const auto& motion :
       {std::function([](LearnBench& b) { return b.jog(jog_for("60rpm", 1s)); }),
        std::function([](LearnBench& b) { return b.move(move_to("720deg", "60rpm", true)); })}) {
    LearnBench bench(131072);
    ASSERT_TRUE(bench.session->download(1, kMode, store_le(1, 2)));
    ASSERT_TRUE(bench.session->download(1, {0x2002, 0x3B}, store_le(8388608, 4)));  // Pn0458
    const auto done = motion(bench);
    ASSERT_FALSE(done.outcome);
    EXPECT_NE(done.outcome.error().message.text().find(
                  "by the 8388608 increments per revolution in its parameters"),
              std::string::npos)
        << done.outcome.error().message.text();
    EXPECT_NE(done.outcome.error().hint.text().find("Pn0458, Pn0456"), std::string::npos)
        << done.outcome.error().hint.text();
    EXPECT_FALSE(bench.energised());
    ASSERT_TRUE(bench.session->can()->send(*can::parse_frame("000#8101")));
    bench.wait(1s);
    const auto again = motion(bench);
    EXPECT_TRUE(again.outcome) << again.outcome.error().message.text();
  }
}

TEST(Learn, GoesOnWithWhatItsParametersTellWhereTheDriveDoesNotHaveTheMonitor) {
  LearnBench bench(131072);
  ASSERT_TRUE(bench.session->download(1, kMode, store_le(1, 2)));
  bench.drive().misbehaviour().unreadable.insert(0x2005);
  const auto done = bench.jog(jog_for("60rpm", 1s));
  EXPECT_TRUE(done.outcome) << done.outcome.error().message.text();
  ASSERT_FALSE(done.unchecked.empty());
  EXPECT_NE(done.unchecked.front().find("not compared with Pn1002"), std::string::npos);
}

TEST(Learn, NamesTheOtherScaleOfTheMonitorWhereThatWouldExplainTheContradiction) {
  LearnBench bench(131072);
  ASSERT_TRUE(bench.session->download(1, kMode, store_le(1, 2)));
  bench.lie([](double tenths) { return tenths * 10; });
  const auto done = bench.jog(jog_for("60rpm", 1s));
  ASSERT_FALSE(done.outcome);
  EXPECT_NE(done.outcome.error().hint.text().find("two scales of Pn1002"), std::string::npos)
      << done.outcome.error().hint.text();

  LearnBench other(131072);
  ASSERT_TRUE(other.session->download(1, kMode, store_le(1, 2)));
  other.lie([](double tenths) { return tenths * 3; });
  const auto thrice = other.jog(jog_for("60rpm", 1s));
  ASSERT_FALSE(thrice.outcome);
  EXPECT_EQ(thrice.outcome.error().hint.text().find("two scales"), std::string::npos);
}

TEST(Learn, LeavesAMotionAloneThatIsToldItsCounts) {
  LearnBench bench(131072);
  ASSERT_TRUE(bench.session->download(1, kMode, store_le(1, 2)));
  ASSERT_TRUE(bench.session->download(1, {0x2002, 0x3B}, store_le(8388608, 4)));
  bench.options.turn = 131072;
  const auto done = bench.jog(jog_for("60rpm", 1s));
  EXPECT_TRUE(done.outcome) << done.outcome.error().message.text();
}

TEST(Learn, StopsAMotorThatItsMonitorShowsTooFastWhereTheCountsWereToldWrong) {
  for (const auto* kind : {"jog", "move", "torque"}) {
    LearnBench bench(10000);
    bench.options.turn = 131072;
    bench.options.speed_limit = "60rpm";
    const auto done = kind == std::string("jog")    ? bench.jog(jog_for("60rpm", 2s))
                      : kind == std::string("move") ? bench.move({"5rev", true, "60rpm"})
                                                    : bench.torque({"20%", 2s});
    ASSERT_FALSE(done.outcome) << kind;
    const auto& error = done.outcome.error();
    EXPECT_EQ(error.code, Errc::negative) << kind << ": " << error.message.text();
    EXPECT_NE(error.message.text().find("rpm by Pn1002, but "), std::string::npos) << error.message.text();
    EXPECT_NE(error.hint.text().find("counts per revolution are probably wrong: `units learn`"),
              std::string::npos);
    EXPECT_TRUE(done.end.verified);
    EXPECT_FALSE(bench.energised());
    double furthest = 0;
    for (const auto& sample : done.samples)
      furthest = std::max(furthest, std::abs(sample[Signal::position].value_or(0)) * 131072 / 10000);
    EXPECT_LT(furthest, 720) << kind << ": not two turns of the motor until it was stopped";
  }
}

TEST(Learn, GoesOnWithToldCountsWhereTheDriveDoesNotHaveTheMonitor) {
  LearnBench bench(131072);
  bench.options.turn = 131072;
  bench.drive().misbehaviour().unreadable.insert(0x2005);
  const auto done = bench.jog(jog_for("60rpm", 1s));
  EXPECT_TRUE(done.outcome) << done.outcome.error().message.text();
  ASSERT_FALSE(done.unchecked.empty());
  EXPECT_NE(done.unchecked.front().find("not compared with Pn1002"), std::string::npos);
}

}  // namespace
}  // namespace servoctl::motion
