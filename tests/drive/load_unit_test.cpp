#include "drive/load_unit.hpp"

#include <gtest/gtest.h>

namespace servoctl::drive {
namespace {

TEST(LoadUnit, TurnsWhatTheLoadMovesIntoRevolutionsOfTheMotor) {
  const auto load = parse_load_unit("20 mm", 10);
  ASSERT_TRUE(load) << load.error().message.text();
  EXPECT_EQ(in_revolutions(*load, "20mm"), "10rev");
  EXPECT_EQ(in_revolutions(*load, "-2 cm"), "-10rev");
  EXPECT_EQ(in_revolutions(*load, "300mm/s"), "150rev/s");
  EXPECT_EQ(in_revolutions(*load, "0.5m/s2"), "250rev/s2");
  for (const auto* other : {"20", "20rev", "20rpm", "mm", "20mm/min", "", "20tabledeg"})
    EXPECT_EQ(in_revolutions(*load, other), std::nullopt) << other;
}

TEST(LoadUnit, TellsWhatTheMotorMovesInItsUnit) {
  const auto load = parse_load_unit("-360 tabledeg", 100);
  ASSERT_TRUE(load) << load.error().message.text();
  const auto way = of_load(*load, 3600, "deg");
  ASSERT_TRUE(way);
  EXPECT_DOUBLE_EQ(way->value, -36);
  EXPECT_EQ(way->unit, "tabledeg");
  const auto speed = of_load(*load, 600, "rpm");
  ASSERT_TRUE(speed);
  EXPECT_DOUBLE_EQ(speed->value, -36);
  EXPECT_EQ(speed->unit, "tabledeg/s");
  EXPECT_FALSE(of_load(*load, 5, "%"));
  EXPECT_EQ(in_revolutions(*load, "36tabledeg"), "-10rev");
}

TEST(LoadUnit, RefusesWhatWouldMeanTwoThings) {
  for (const auto* bad : {"360 deg", "1 rev", "5", "0 mm", "mm", "5 s", "100 rpm", "1 inc", "5 mm/s", "5 %"})
    EXPECT_FALSE(parse_load_unit(bad, 1)) << bad;
}

}  // namespace
}  // namespace servoctl::drive
