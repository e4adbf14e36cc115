#include "base/decade.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace servoctl {
namespace {

TEST(Decade, IsThePowerOfTenAtOrBelow) {
  EXPECT_EQ(decade_of(1), 0);
  EXPECT_EQ(decade_of(9.999999), 0);
  EXPECT_EQ(decade_of(10), 1);
  EXPECT_EQ(decade_of(-1000), 3);
  EXPECT_EQ(decade_of(0.005), -3);
  EXPECT_EQ(decade_of(0.001), -3);
  EXPECT_EQ(decade_of(std::numeric_limits<double>::max()), 308);
  EXPECT_EQ(decade_of(std::numeric_limits<double>::denorm_min()), -324);
}

TEST(Decade, PowersOfTenAreTheDoublesThatAreWritten) {
  EXPECT_EQ(power_of_ten(0), 1.0);
  EXPECT_EQ(power_of_ten(3), 1e3);
  EXPECT_EQ(power_of_ten(-3), 1e-3);
  EXPECT_EQ(power_of_ten(22), 1e22);
  EXPECT_EQ(power_of_ten(-400), 0.0);
  EXPECT_TRUE(std::isinf(power_of_ten(400)));
  for (int exponent = -300; exponent <= 300; ++exponent)
    EXPECT_EQ(decade_of(power_of_ten(exponent)), exponent);
}

}  // namespace
}  // namespace servoctl
