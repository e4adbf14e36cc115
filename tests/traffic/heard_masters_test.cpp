// A heartbeat whose consumers were all told to forget it may end; any other end is a loss.
#include "traffic/heard_masters.hpp"

#include <gtest/gtest.h>

#include <chrono>

#include "canopen/sdo_frame.hpp"

namespace servoctl::traffic {
namespace {

using std::chrono::milliseconds;

const TimePoint kBegin{std::chrono::seconds(10)};

/// A write of 1016h:1 to node 1: 500 ms of this producer, or of nobody.
can::Frame consumes(std::uint8_t producer) {
  const bool on = producer != 0;
  const std::uint8_t data[] = {
      0x23, 0x16, 0x10, 0x01, std::uint8_t(on ? 0xF4 : 0), std::uint8_t(on ? 1 : 0), producer, 0};
  return can::make_frame(0x601, data);
}

can::Frame confirmed() { return canopen::sdo_frame(0x581, 0x60, {0x1016, 1}); }

can::Frame beat(std::uint8_t node, std::uint8_t state) {
  return can::make_frame(0x700U + node, std::span(&state, 1));
}

class HeardMastersTest : public testing::Test {
 protected:
  void hear(const can::Frame& frame, int at) { masters_.on_frame(frame, kBegin + milliseconds(at)); }
  void write(std::uint8_t producer, int at) {
    hear(consumes(producer), at);
    hear(confirmed(), at);
  }
  bool has_left(std::uint8_t node, int at) const {
    return masters_.has_left(node, kBegin + milliseconds(at));
  }

  HeardMasters masters_;
};

TEST_F(HeardMastersTest, AMasterThatTookItselfOutHasLeft) {
  write(127, 0);
  hear(beat(127, 5), 100);
  EXPECT_FALSE(has_left(127, 900)) << "it is consumed still";
  write(0, 1000);
  EXPECT_TRUE(has_left(127, 1800));
  EXPECT_FALSE(has_left(127, 4100)) << "it went on, and was lost later";
}

TEST_F(HeardMastersTest, OneThatIsConsumedAgainHasNotLeft) {
  write(127, 0);
  write(0, 100);
  write(127, 200);
  EXPECT_FALSE(has_left(127, 300));
}

TEST_F(HeardMastersTest, AWriteCountsWhenItIsConfirmed) {
  write(127, 0);
  hear(consumes(0), 100);
  EXPECT_FALSE(has_left(127, 200));
  hear(canopen::sdo_frame(0x581, 0x80, {0x1016, 1}, 0x08000022), 110);
  hear(confirmed(), 120);
  EXPECT_FALSE(has_left(127, 200)) << "the drive refused it";
}

TEST_F(HeardMastersTest, TheLengthOfASegmentedWriteIsNoProducer) {
  write(127, 0);
  hear(canopen::sdo_frame(0x601, 0x21, {0x1016, 1}, 4), 100);
  hear(confirmed(), 110);
  EXPECT_FALSE(has_left(127, 200));
}

TEST_F(HeardMastersTest, ADriveIsLostWhoeverConsumedIt) {
  write(5, 0);
  write(9, 10);  // 1016h:1 names another now.
  EXPECT_TRUE(has_left(5, 100));
  hear(beat(5, 5), 20);
  EXPECT_TRUE(has_left(5, 100)) << "a master has a heartbeat as well";
  hear(beat(5, 0), 30);
  EXPECT_FALSE(has_left(5, 100)) << "it started as a drive does";
}

TEST_F(HeardMastersTest, WhoAnswersOrSendsPdosIsADrive) {
  const std::uint8_t data[8] = {};
  for (const std::uint32_t id : {0x080U, 0x180U, 0x580U}) {
    HeardMasters masters;
    for (const std::uint8_t producer : {std::uint8_t(5), std::uint8_t(0)}) {
      masters.on_frame(consumes(producer), kBegin);
      masters.on_frame(confirmed(), kBegin);
    }
    EXPECT_TRUE(masters.has_left(5, kBegin));
    masters.on_frame(can::make_frame(id + 5, data), kBegin);
    EXPECT_FALSE(masters.has_left(5, kBegin)) << id;
  }
}

}  // namespace
}  // namespace servoctl::traffic
