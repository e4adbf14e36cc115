#include "ethernet/frame_limits.hpp"

#include <gtest/gtest.h>

namespace servoctl::ethernet {
namespace {

TEST(FrameLimits, AFrameHas60To1514Bytes) {
  for (const std::size_t size : {60U, 61U, 1513U, 1514U}) EXPECT_TRUE(check_frame(Bytes(size))) << size;
  for (const std::size_t size : {0U, 59U, 1515U}) {
    const auto checked = check_frame(Bytes(size));
    ASSERT_FALSE(checked) << size;
    EXPECT_EQ(checked.error().code, Errc::bug);
  }
}

}  // namespace
}  // namespace servoctl::ethernet
