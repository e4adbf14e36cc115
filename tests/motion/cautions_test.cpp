// What is told before a motor moves: cautions, inputs, and what the manual says of a lost communication.
#include "motion_support.hpp"

namespace servoctl::motion {
namespace {

struct Look {
  std::vector<PreflightItem> items;
  bool has(std::string_view part, PreflightItem::Weight weight = PreflightItem::Weight::caution) const {
    return std::any_of(items.begin(), items.end(), [&](const auto& item) {
      return item.weight == weight && item.text.find(part) != std::string::npos;
    });
  }
};

Look look(MotionBench& bench) {
  Motion motion(*bench.session, bench.profile(), 1, bench.options);
  EXPECT_TRUE(motion.prepare());
  auto items = motion.look(false);
  EXPECT_TRUE(items.has_value());
  return {items ? *items : std::vector<PreflightItem>{}};
}

TEST(Cautions, AboutParametersThatNobodyCanReadAreToldAlways) {
  MotionBench bench("sv2");
  const auto told = look(bench);
  EXPECT_TRUE(told.has(
      "PA-20 cannot be read (check the panel): PA-20 = 1 (factory value): the drive ignores both limit switches"));
  EXPECT_TRUE(told.has("PA-74 cannot be read"));
}

TEST(Cautions, AboutTheElectronicGearHoldUnlessItIsZero) {
  MotionBench bench("da200", 10000);
  EXPECT_FALSE(look(bench).has("P0.22"));
  const auto size = bench.drive().value({0x2016, 0}).size();
  ASSERT_TRUE(bench.session->download(1, {0x2016, 0}, store_le(1, size)));
  EXPECT_TRUE(look(bench).has("While P0.22 is not 0"));
}

TEST(Cautions, AboutForcedLimitInputsSayWhichOneIsForced) {
  MotionBench bench("gsd600", 131072);
  const char* texts[] = {"", "the drive ignores the positive limit switch.",
                         "the drive ignores the negative limit switch.",
                         "the drive ignores both limit switches."};
  for (unsigned value = 0; value < 4; ++value) {
    ASSERT_TRUE(bench.session->download(1, {0x2003, 4}, store_le(value, 2)));
    const auto told = look(bench);
    for (unsigned i = 1; i < 4; ++i) EXPECT_EQ(told.has(texts[i]), i == value) << value << " " << texts[i];
  }
}

TEST(Cautions, AboutFactoryLimitsEndWhereOthersAreSet) {
  MotionBench bench("dm", 10000);
  EXPECT_TRUE(look(bench).has("The speed limit 6080h does not protect"));
  EXPECT_TRUE(look(bench).has("The torque limit 6072h does not protect"));
  ASSERT_TRUE(bench.session->download(1, {0x6080, 0}, {0x00, 0x00, 0x48, 0x41}));  // 12.5
  ASSERT_TRUE(bench.session->download(1, {0x6072, 0}, {0x00, 0x00, 0x40, 0x40}));  // 3.0
  EXPECT_FALSE(look(bench).has("does not protect"));
}

TEST(Cautions, SpeakChineseWithTheirLead) {
  MotionBench bench("sv2");
  Motion motion(*bench.session, bench.profile(), 1, bench.options);
  ASSERT_TRUE(motion.prepare());
  const Look told{motion.look(true).value()};
  EXPECT_TRUE(told.has("无法读取 PA-20（查看面板）：PA-20 = 1（出厂值）：驱动器忽略正负限位开关。"));
  EXPECT_FALSE(told.has("cannot be read"));
}

TEST(Cautions, NameWhatCanOpenNeedsWhereItIsSetOtherwise) {
  MotionBench bench("gsd600", 131072);
  EXPECT_FALSE(look(bench).has("is needed for CANopen"));
  const auto place = *drive::place_of(bench.profile(), "Pn0000");
  ASSERT_TRUE(bench.session->download(1, place, store_le(5, 2)));
  EXPECT_TRUE(look(bench).has("it is 5, and 8 is needed for CANopen: the drive may not obey"));
}

TEST(Inputs, AreReadByThePolarityOfTheFamily) {
  MotionBench bench("gsd600", 131072);
  EXPECT_TRUE(look(bench).has("60FDh is 0x003F0004: no limit, no home switch", PreflightItem::Weight::good));
  bench.drive().track().home.stuck = true;
  EXPECT_TRUE(look(bench).has("60FDh is 0x003F0000: home switch", PreflightItem::Weight::good));
  bench.drive().track().positive_limit.stuck = true;
  EXPECT_TRUE(look(bench).has("60FDh is 0x003F0002: positive limit, home switch"));
  MotionBench other("sv2");
  EXPECT_TRUE(look(other).has("the manual does not state the active level", PreflightItem::Weight::good));
}

TEST(LostCommunication, ThatTheManualNamesAnAlarmForIsNotSaidToStopNothing) {
  for (const auto& [family, alarm] : {std::pair("da200", "Er26-b, Er26-c"), std::pair("sv2", "Err-61")}) {
    MotionBench bench(family, 10000);
    const auto told = look(bench);
    if (!told.has("none")) continue;  // It has a watchdog of its own.
    EXPECT_TRUE(told.has(std::string("the manual names alarm ") + alarm)) << family;
    EXPECT_FALSE(told.has("none: nothing is known that stops the drive")) << family;
  }
  WatchdogPlan nothing;
  EXPECT_EQ(to_string(nothing),
            "none: nothing is known that stops the drive if the cable is cut or servoctl dies");
  nothing.alarms = {"AL.20"};
  EXPECT_NE(to_string(nothing).find("alarm AL.20 for lost communication"), std::string::npos);
}

}  // namespace
}  // namespace servoctl::motion
