#include "drive/soft_ramp.hpp"

#include <gtest/gtest.h>

namespace servoctl::drive {
namespace {

TEST(SoftRamp, IsTheAccelerationThatReachesTheSpeedInTheTime) {
  EXPECT_EQ(soft_ramp("rpm/s", "rpm", 60, 0.5), 120);
  EXPECT_EQ(soft_ramp("rpm/s", "rpm", -60, 0.5), 120);
  EXPECT_EQ(soft_ramp("inc/s2", "inc/s", 131072, 0.5), 262144);
}

TEST(SoftRamp, GivenAsATimeToFullSpeedIsLongerForASlowerMoveWithinBounds) {
  EXPECT_EQ(soft_ramp("ms", "rpm", 3000, 0.5), 500);
  EXPECT_EQ(soft_ramp("ms", "rpm", 600, 0.5), 2500);
  EXPECT_EQ(soft_ramp("ms", "rpm", 30, 0.5), 30000);
  EXPECT_EQ(soft_ramp("ms", "rpm", 30000, 0.5), 200);
}

TEST(SoftRamp, IsNotInventedWhereTheUnitsDoNotFit) {
  EXPECT_FALSE(soft_ramp("inc/s2", "rpm", 60, 0.5));
  EXPECT_FALSE(soft_ramp("", "rpm", 60, 0.5));
  EXPECT_FALSE(soft_ramp("rpm/s", "rpm", 0, 0.5));
}

}  // namespace
}  // namespace servoctl::drive
