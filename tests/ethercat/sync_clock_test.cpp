// SYNC0: when its first pulse comes, and how cycles are kept between two.
#include "ethercat/sync_clock.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "ethercat/registers.hpp"

namespace servoctl::ethercat {
namespace {

using namespace std::chrono_literals;

constexpr auto kClockSlave = SlaveAddress::station(0x1001);

/// A slave whose clock runs at another speed than the master's, at the end of a wire that takes no time.
class SyncClockTest : public testing::Test {
 protected:
  SyncClockTest() {
    image_.add(1, ProcessMapping{{{{0x6040, 0}, 16}}, {{{0x6041, 0}, 16}}});
    EXPECT_TRUE(image_.set(1, {0x6040, 0}, Bytes{0, 0}));
  }
  std::uint64_t slave_time() const {
    const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(now_.time_since_epoch()).count();
    const auto time = static_cast<std::uint64_t>(static_cast<double>(ns) * speed_) + 777'000;
    return bits_ == 64 ? time : static_cast<std::uint32_t>(time);
  }
  void use_clock_of(unsigned bits) {
    bits_ = bits;
    clock_ = SyncClock(kClockSlave, 4ms, bits);
  }
  void run(Duration time) {
    for (const auto end = now_ + time; now_ < end;) {
      now_ = std::max(now_, std::min(end, image_.deadline())) + jitter();
      ring_.on_time(now_);
      image_.serve(ring_, now_);
      clock_.serve(ring_, image_);
      while (const auto frame = ring_.take_frame(now_)) answer(*frame);
      image_.serve(ring_, now_);
      clock_.serve(ring_, image_);
    }
  }
  /// 0910h is answered with the slave's time, the image with a full counter.
  void answer(ByteSpan sent) {
    Bytes frame(sent.begin(), sent.end());
    for (std::size_t at = 16; at + 12 <= frame.size();) {
      const auto length = (frame[at + 6] | static_cast<unsigned>(frame[at + 7]) << 8U) & 0x7FFU;
      const bool more = (frame[at + 7] & 0x80U) != 0;
      const bool time = frame[at] == static_cast<std::uint8_t>(Command::fprd);
      if (time) {
        const auto bytes = store_le(slave_time(), bits_ / 8);
        EXPECT_EQ(length, bits_ / 8);
        std::copy(bytes.begin(), bytes.end(), frame.begin() + static_cast<std::ptrdiff_t>(at + 10));
      }
      frame[at + 10 + length] = time ? 1 : 3;
      if (!more) break;
      at += 12 + length;
    }
    EXPECT_TRUE(ring_.on_frame(frame, now_));
  }
  Duration jitter() {
    return std::chrono::microseconds((seed_ = seed_ * 1103515245U + 12345U) >> 16U & 0x3FU);
  }

  TimePoint now_{1s};
  double speed_ = 1;
  unsigned bits_ = 64;
  unsigned seed_ = 1;
  Ring ring_{Ring::Options{}};
  ProcessImage image_{ProcessImage::Options{}};
  SyncClock clock_{kClockSlave, 4ms};
};

TEST_F(SyncClockTest, TheFirstPulseIsAWholeCycleAtLeastATenthOfASecondAhead) {
  const auto writes = clock_.start(1'000'000'001);
  ASSERT_EQ(writes.size(), 5U);
  EXPECT_EQ(writes[2].address >> 16U, reg::kDcStart);
  EXPECT_EQ(load_le(writes[2].data), 1'104'000'000U);
  EXPECT_EQ(writes[3].address >> 16U, reg::kDcSync0Cycle);
  EXPECT_EQ(load_le(writes[3].data), 4'000'000U);
  EXPECT_EQ(writes[4].data, Bytes{0x03});
}

TEST_F(SyncClockTest, CyclesComeIntoTheMiddleAndStayThereThoughTheClocksDrift) {
  for (const double speed : {1.0, 1.0002, 0.9998}) {
    speed_ = speed;
    (void)clock_.start(slave_time());
    ASSERT_TRUE(image_.start(now_));
    run(90ms);
    EXPECT_FALSE(clock_.is_locked()) << "no pulse has come yet";
    run(300ms);
    EXPECT_TRUE(clock_.is_locked()) << speed;
    Duration farthest{};
    for (int i = 0; i < 500; ++i) {
      run(4ms);
      farthest = std::max(farthest, clock_.distance());
    }
    EXPECT_LT(farthest, 300us) << speed;
    image_.stop();
    image_.leave(ring_);
    clock_.leave(ring_);
  }
}

/// 2^32 ns are no whole number of cycles.
TEST_F(SyncClockTest, AClockOf32BitsIsCountedOnOverItsWraps) {
  use_clock_of(32);
  const auto writes = clock_.start(slave_time());
  EXPECT_EQ(writes[2].data.size(), 4U) << "0990h has 32 bits as well";
  ASSERT_TRUE(image_.start(now_));
  run(400ms);
  ASSERT_TRUE(clock_.is_locked());
  Duration farthest{};
  for (int i = 0; i < 5000; ++i) {  // 20 s: more than four wraps.
    run(4ms);
    farthest = std::max(farthest, clock_.distance());
  }
  EXPECT_LT(farthest, 300us);
  EXPECT_TRUE(clock_.is_locked());
}

TEST_F(SyncClockTest, AFirstPulseBehindAWrapIsStillToCome) {
  use_clock_of(32);
  const auto writes = clock_.start(0xFFFF'FF00);
  EXPECT_EQ(load_le(writes[2].data),
            (0xFFFF'FF00ULL + 104'000'000ULL) / 4'000'000ULL * 4'000'000ULL % (1ULL << 32U))
      << "a tenth of a second ahead, rounded up to whole cycles, in 32 bits";
}

TEST_F(SyncClockTest, OnlyCodesOfSynchronisationDemandIt) {
  EXPECT_TRUE(demands_clock(0x0027));
  EXPECT_TRUE(demands_clock(0x0030));
  EXPECT_FALSE(demands_clock(0x001B));
  EXPECT_FALSE(demands_clock(0x001E));
}

}  // namespace
}  // namespace servoctl::ethercat
