#include "session/fitting_size.hpp"

#include <gtest/gtest.h>

namespace servoctl::session {
namespace {

TEST(FittingSize, KeepsTheNumberAndItsSign) {
  using od::DataType;
  EXPECT_EQ(in_size({0x58, 0x02, 0, 0}, DataType::u32, 2), (Bytes{0x58, 0x02}));
  EXPECT_EQ(in_size({0xFD, 0xFF, 0xFF, 0xFF}, DataType::i32, 2), (Bytes{0xFD, 0xFF}));
  EXPECT_EQ(in_size({0xFD}, DataType::i8, 4), (Bytes{0xFD, 0xFF, 0xFF, 0xFF}));
  EXPECT_EQ(in_size({0xFD}, DataType::u8, 2), (Bytes{0xFD, 0}));
}

TEST(FittingSize, RefusesANumberThatWouldBecomeAnother) {
  using od::DataType;
  EXPECT_FALSE(in_size({0x70, 0x11, 0x01, 0}, DataType::u32, 2));
  EXPECT_FALSE(in_size({0xFF, 0xFF, 0, 0}, DataType::i32, 2));  // 65535 would be -1.
  EXPECT_FALSE(in_size({0, 0x80, 0xFE, 0xFF}, DataType::i32, 2));
  EXPECT_FALSE(in_size({0, 0, 0x80, 0x3F}, DataType::f32, 2));
}

}  // namespace
}  // namespace servoctl::session
