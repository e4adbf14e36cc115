#include "base/run_delay.hpp"

#include <gtest/gtest.h>

namespace servoctl {
namespace {

TEST(RunDelay, IsTheSecondNumberInNanoseconds) {
  EXPECT_EQ(parse_run_delay("39254207 522223441 29\n"), Duration(522223));
  for (const auto* text : {"", "1 2", "1 2 3 4", "a b c", "1 -2 3", "1 2x 3"})
    EXPECT_FALSE(parse_run_delay(text)) << text;
}

TEST(RunDelay, NeverGoesBack) {
  const auto before = run_delay();
  EXPECT_GE(before, Duration::zero());
  EXPECT_GE(run_delay(), before);
}

}  // namespace
}  // namespace servoctl
