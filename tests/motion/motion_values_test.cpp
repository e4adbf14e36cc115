// What is asked for is what is done, or it is refused or told: rounding, limits, and what was measured.
#include "motion_support.hpp"

#include <ostream>

namespace servoctl::motion {
namespace {

using namespace std::chrono_literals;

struct Asked {
  const char* name;
  double turn;
};
constexpr Asked kAskedFamilies[] = {{"cia402", 10000}, {"gsd600", 131072}, {"da200", 10000},
                                    {"sv2", 0},        {"ts", 10000},      {"dm", 0}};
void PrintTo(const Asked& family, std::ostream* out) { *out << family.name; }

class ValuesOfFamily : public testing::TestWithParam<Asked> {
 protected:
  ValuesOfFamily() : bench(GetParam().name, GetParam().turn) {}
  void expect_refused(const MotionReport& done, std::string_view about) {
    ASSERT_FALSE(done.outcome) << about;
    const auto code = done.outcome.error().code;
    EXPECT_TRUE(code == Errc::usage || code == Errc::refused)
        << about << ": " << done.outcome.error().message.text();
    EXPECT_FALSE(done.outcome.error().hint.text().empty() && done.outcome.error().message.text().empty());
    EXPECT_FALSE(done.begun) << about;
    for (const auto& frame : bench.bus->frames)
      EXPECT_NE(frame.substr(0, 5), "601#2") << about << " " << frame;
  }
  MotionBench bench;
};

TEST_P(ValuesOfFamily, ALimitIsMoreThanZero) {
  for (const char* text : {"-50rpm", "0rpm", "+-5rpm", "nanrpm", "infrpm", "1e400rpm"}) {
    bench.options.speed_limit = text;
    expect_refused(bench.jog(jog_for("30rpm", 1s)), text);
  }
  bench.options.speed_limit.clear();
  bench.options.window = "-5deg";
  expect_refused(bench.jog(jog_for("30rpm", 1s)), "--window -5deg");
  bench.options.window.clear();
  bench.options.max_torque = "-5%";
  expect_refused(bench.jog(jog_for("30rpm", 1s)), "--max-torque -5%");
  bench.options.max_torque.clear();
  bench.options.acceleration = "0";
  expect_refused(bench.jog(jog_for("30rpm", 1s)), "--accel 0");
}

TEST_P(ValuesOfFamily, ANumberWithoutAUnitMovesNothing) {
  expect_refused(bench.move(move_to("90", "30rpm", true)), "move 90");
  expect_refused(bench.move(move_to("90deg", "30", true)), "--speed 30");
  expect_refused(bench.jog(jog_for("60", 1s)), "jog 60");
  expect_refused(bench.jog(jog_for("0x3C", 1s)), "jog 0x3C");
  const auto bare = bench.move(move_to("90", "30rpm", true));
  EXPECT_EQ(bare.outcome.error().message.text(), "'90' has no unit");
  EXPECT_NE(bare.outcome.error().hint.text().find("deg, rev, rad"), std::string::npos)
      << bare.outcome.error().hint.text();
  bench.options.window = "10";
  expect_refused(bench.jog(jog_for("30rpm", 1s)), "--window 10");
  bench.options.window.clear();
  bench.options.speed_limit = "100";
  expect_refused(bench.torque({.torque = "1%", .length = 100ms}), "--limit 100");
  bench.options.speed_limit = "100rpm";
  expect_refused(bench.torque({.torque = "1", .length = 100ms}), "torque 1");
}

TEST_P(ValuesOfFamily, ZeroNeedsNoUnit) {
  const auto done = bench.move(move_to("0", "30rpm"));
  EXPECT_TRUE(done.outcome) << done.outcome.error().message.text();
}

TEST_P(ValuesOfFamily, ATorqueAboveTheRatedOneIsRefusedAndRaisedKnowingly) {
  bench.options.speed_limit = "100rpm";
  const bool in_nm = std::string(GetParam().name) == "dm";
  for (const char* text : {"1e30Nm", "1000%", "nan%", "inf", "+-5%", "1e300%", "-101%", "4Nm"})
    expect_refused(bench.torque({.torque = text, .length = 500ms}), text);
  bench.options.max_torque = in_nm ? "4Nm" : "120%";
  const auto more = bench.torque({.torque = in_nm ? "3.5Nm" : "110%", .length = 100ms});
  if (!more.outcome) {
    EXPECT_EQ(more.outcome.error().code, Errc::negative) << more.outcome.error().message.text();
  }
  EXPECT_TRUE(more.begun);
  // Where nobody can watch it, it bounds what is asked and nothing else.
  const auto jog = bench.jog(jog_for("30rpm", 100ms));
  EXPECT_EQ(jog.begun, bench.profile().dictionary.find({0x6077, 0}) != nullptr);
}

TEST_P(ValuesOfFamily, AWayThatRoundsToNothingIsRefused) {
  if (GetParam().turn == 0) return;
  bench.options.turn = 1;
  bench.options.speed_limit = "30rpm";
  expect_refused(bench.move(move_to("90deg", "30rpm", true)), "a quarter of a count");
  expect_refused(bench.move(move_to("90deg", "30rpm")), "a quarter of a count, absolute");
}

TEST_P(ValuesOfFamily, ASpeedBetweenTwoStepsIsToldOrRefused) {
  Motion motion(*bench.session, bench.profile(), 1, bench.options);
  ASSERT_TRUE(motion.prepare());
  const auto plan = plan_jog(motion, jog_for("61.5rpm", 1s));
  ASSERT_TRUE(plan) << plan.error().message.text();
  if (plan->value == 61.5 || std::abs(plan->value - 61.5) < 0.07) return;
  ASSERT_FALSE(plan->notes.empty());
  EXPECT_NE(plan->notes.front().find("61.5 rpm is 62 rpm"), std::string::npos) << plan->notes.front();
  expect_refused(bench.jog(jog_for("1.5rpm", 1s)), "1.5rpm");
  expect_refused(bench.jog(jog_for("0.2rpm", 1s)), "0.2rpm");
}

TEST_P(ValuesOfFamily, HomingByNoMethodOrWithoutSpeedIsRefusedWithTheWayOut) {
  if (!bench.profile().rules.motion.homing) return;
  bench.obey_switches();
  bench.bus->frames.clear();
  auto home = home_by("0");
  auto done = bench.home(home);
  expect_refused(done, "method 0");
  if (bench.profile().rules.motion.no_homing.empty()) {
    home = home_by("17");
  } else {
    expect_refused(bench.home(home_by("35")), "a method that does nothing");
    home = home_by("17");
  }
  home.fast = "0rpm";
  done = bench.home(home);
  expect_refused(done, "speed 0");
  const auto& why = done.outcome.error();
  if (why.message.text().find("out of range: 1") != std::string::npos)
    return;  // The object itself holds no 0.
  EXPECT_NE(why.message.text().find("homing would never end"), std::string::npos) << why.message.text();
  EXPECT_NE(why.hint.text().find("--speed"), std::string::npos);
}

TEST_P(ValuesOfFamily, ASpeedThatIsNotTheOneAskedForIsADifference) {
  const auto good = bench.jog(jog_for("60rpm", 2s));
  ASSERT_TRUE(good.outcome) << good.outcome.error().message.text();
  EXPECT_EQ(good.differences, std::vector<std::string>{});
  EXPECT_EQ(good.unchecked, std::vector<std::string>{});
  const auto shorter = bench.jog(jog_for("60rpm", 200ms));
  ASSERT_TRUE(shorter.outcome);
  EXPECT_EQ(shorter.differences, std::vector<std::string>{});
  EXPECT_EQ(shorter.unchecked.size(), 1U);
}

INSTANTIATE_TEST_SUITE_P(Families, ValuesOfFamily, testing::ValuesIn(kAskedFamilies),
                         [](const auto& test) { return std::string(test.param.name); });

/// Changes what the drive tells of an object in 4 bytes.
void distort(MotionBus& bus, std::uint16_t index, std::function<double(double)> change) {
  bus.alter = [index, change = std::move(change)](can::Frame& frame) {
    if (frame.id != 0x581 || load_le(std::span(frame.data).subspan(1, 2)) != index) return;
    const auto value = static_cast<std::int32_t>(load_le(std::span(frame.data).subspan(4, 4)));
    store_le(static_cast<std::uint64_t>(static_cast<std::int64_t>(change(value))),
             std::span(frame.data).subspan(4, 4));
  };
}

class Measured : public testing::Test {
 protected:
  MotionBench bench{"gsd600", 131072};
};

TEST_F(Measured, AJogAtHalfItsSpeedIsDoneBut) {
  distort(*bench.bus, 0x606C, [](double v) { return v / 2; });
  const auto done = bench.jog(jog_for("60rpm", 2s));
  ASSERT_TRUE(done.outcome) << done.outcome.error().message.text();
  ASSERT_EQ(done.differences.size(), 1U);
  EXPECT_EQ(done.differences.front(), "the speed was 30 rpm; 60 rpm was commanded");
  EXPECT_FALSE(bench.energised());
}

TEST_F(Measured, AMoveThatAWidePositionWindowCallsDoneIsDoneBut) {
  const auto done_well = bench.move(move_to("90deg", "60rpm"));
  ASSERT_TRUE(done_well.outcome) << done_well.outcome.error().message.text();
  EXPECT_EQ(done_well.differences, std::vector<std::string>{});
  ASSERT_TRUE(bench.session->download(1, {0x6067, 0}, store_le(131072, 4)));
  distort(*bench.bus, 0x6064, [](double v) { return v - 0.05 * 131072; });  // It is 18 degrees off.
  const auto done = bench.move(move_to("180deg", "60rpm"));
  ASSERT_TRUE(done.outcome) << done.outcome.error().message.text();
  ASSERT_EQ(done.differences.size(), 1U);
  EXPECT_NE(done.differences.front().find("180 deg was commanded"), std::string::npos);
}

TEST(SpeedLimit, OfTheDriveItselfIsRaisedByNoOption) {
  MotionBench bench("cia402", 10000);
  ASSERT_TRUE(bench.session->download(1, {0x607F, 0}, store_le(10000, 4)));  // 60 rpm of 10000 counts.
  const auto done = bench.jog(jog_for("100rpm", 1s));
  ASSERT_FALSE(done.outcome);
  EXPECT_NE(done.outcome.error().message.text().find("what the drive allows, 60 rpm"), std::string::npos)
      << done.outcome.error().message.text();
  EXPECT_EQ(done.outcome.error().hint.text().find("--limit"), std::string::npos)
      << done.outcome.error().hint.text();
  EXPECT_FALSE(done.begun);
}

TEST_F(Measured, ATorqueThatIsNotThereIsDoneBut) {
  bench.options.speed_limit = "200rpm";
  MotionBench other("ts", 10000);
  other.options.speed_limit = "250rpm";
  other.bus->alter = [](can::Frame& frame) {
    if (frame.id == 0x581 && load_le(std::span(frame.data).subspan(1, 2)) == 0x6077)
      store_le(std::uint64_t{5}, std::span(frame.data).subspan(4, 2));
  };
  const auto done = other.torque({.torque = "20%", .length = 1s});
  ASSERT_TRUE(done.outcome) << done.outcome.error().message.text();
  const auto all = done.differences.size() + done.unchecked.size();
  EXPECT_GE(all, 1U);
}

TEST_F(Measured, KeysThatNobodyHoldsForFiveSecondsEndTheJog) {
  Jog jog;
  jog.speed = "60rpm";
  const auto begin = bench.session->now();
  jog.keys = [&] {
    const auto time = bench.session->now() - begin;
    return time > 3s && time < 5s ? HoldKey::plus : HoldKey::none;
  };
  const auto done = bench.jog(jog);
  ASSERT_TRUE(done.outcome) << done.outcome.error().message.text();
  const auto took = bench.session->now() - begin;
  EXPECT_GT(took, 9s);
  EXPECT_LT(took, 13s);
  ASSERT_EQ(done.unchecked.size(), 1U);
  EXPECT_EQ(done.unchecked.front(), "no key was held for 5 s: the jog has ended");
  EXPECT_FALSE(bench.energised());
}

TEST(TorqueSlope, ThatRoundsToNothingIsTheSmallestStepAndTold) {
  MotionBench bench("sv2");
  bench.options.speed_limit = "60rpm";
  Motion motion(*bench.session, bench.profile(), 1, bench.options);
  ASSERT_TRUE(motion.prepare());
  const auto plan = plan_torque(motion, {.torque = "5%", .length = 500ms});
  ASSERT_TRUE(plan) << plan.error().message.text();
  const auto slope = std::find_if(plan->settings.begin(), plan->settings.end(),
                                  [](const auto& s) { return s.first == objects::kTorqueSlope; });
  ASSERT_NE(slope, plan->settings.end());
  EXPECT_EQ(load_le(slope->second), 1U);
  EXPECT_TRUE(std::any_of(plan->notes.begin(), plan->notes.end(), [](const auto& note) {
    return note.find("0x6087:0 is set to 100 %/s") != std::string::npos;
  })) << plan->notes.front();
}

TEST(SpeedLimitInTorqueMode, OfTheDriveIsSetInItsOwnUnit) {
  MotionBench bench("sv2");
  bench.options.speed_limit = "60rpm";
  Motion motion(*bench.session, bench.profile(), 1, bench.options);
  ASSERT_TRUE(motion.prepare());
  const auto plan = plan_torque(motion, {.torque = "5%", .length = 500ms});
  ASSERT_TRUE(plan);
  const auto limit = std::find_if(plan->settings.begin(), plan->settings.end(), [](const auto& s) {
    return s.first == ObjectAddress{0x2000, 5};
  });
  ASSERT_NE(limit, plan->settings.end());
  EXPECT_EQ(load_le(limit->second), 60U);
  const auto done = bench.torque({.torque = "5%", .length = 500ms});
  ASSERT_TRUE(done.outcome) << done.outcome.error().message.text();
  EXPECT_EQ(bench.changed(), std::vector<std::string>{});
}

}  // namespace
}  // namespace servoctl::motion
