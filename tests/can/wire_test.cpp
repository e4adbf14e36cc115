#include "can/wire.hpp"

#include <gtest/gtest.h>

namespace servoctl::can {
namespace {

std::uint32_t bits(const char* text) { return bits_on_wire(parse_frame(text).value()); }

TEST(BitsOnWire, LieBetweenNoStuffBitAndTheMostThereCanBe) {
  // 44 + 3 bits and eight a byte; at most a stuff bit for every four of the 34 + 8n bits it applies to.
  for (const auto* text :
       {"000#", "7FF#", "2AA#AA55AA55AA55AA55", "080#", "181#3702E8030000", "601#4041600000000000"}) {
    const auto size = parse_frame(text)->size * 8U;
    EXPECT_GE(bits(text), 47 + size) << text;
    EXPECT_LE(bits(text), 47 + size + (33 + size) / 4) << text;
  }
  EXPECT_GE(bits("12345678#0011"), 67U + 16U);
}

TEST(BitsOnWire, HaveAStuffBitAfterFiveEqualOnes) {
  // Header and checksum are 34 zeros: a one is stuffed in after every five of them.
  EXPECT_EQ(bits("000#"), 47U + 6U);
}

TEST(BitsOnWire, OfARemoteFrameAreThoseOfNoData) {
  EXPECT_GE(bits("701#R8"), 47U);
  EXPECT_LE(bits("701#R8"), 47U + 8U);
  EXPECT_EQ(bits("20000004#0010000000000000"), 0U);
}

}  // namespace
}  // namespace servoctl::can
