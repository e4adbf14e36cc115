#include "base/timespec.hpp"

#include <gtest/gtest.h>

namespace servoctl {
namespace {

using namespace std::chrono_literals;

/// Subtracting the clock from TimePoint::min() overflows, and the wait would last as long as it may.
TEST(LeftBetween, OfWhatIsDueAtOnceNothingIsLeft) {
  const TimePoint now(5s);
  EXPECT_EQ(left_between(now, TimePoint::min()), 0us);
  EXPECT_EQ(left_between(now, now - 1us), 0us);
  EXPECT_EQ(left_between(now, now), 0us);
  EXPECT_EQ(left_between(now, now + 3ms), 3ms);
  EXPECT_GT(left_between(now, kNever), 24h);
  EXPECT_EQ(left_until(TimePoint::min()), 0us);
}

}  // namespace
}  // namespace servoctl
