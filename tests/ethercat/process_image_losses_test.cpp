#include <initializer_list>

#include "process_image_fixture.hpp"

namespace servoctl::ethercat {
namespace {

using namespace std::chrono_literals;

TEST_F(ProcessImageTest, ACounterSaysWhichHalfIsMissing) {
  preset();
  ASSERT_TRUE(image.start(now));
  cycle();
  wire[0].gives = false;
  wire[1].takes = false;
  cycle();
  cycle();
  EXPECT_EQ(image.counts(1).short_inputs, 2U);
  EXPECT_EQ(image.counts(1).short_outputs, 0U);
  EXPECT_EQ(image.counts(2).short_inputs, 0U);
  EXPECT_EQ(image.counts(2).short_outputs, 2U);
  EXPECT_EQ(image.counts(1).missing, 2U);
  EXPECT_EQ(ring.statistics().short_counters, 4U);
  wire[0].gives = true;
  cycle();
  EXPECT_EQ(image.counts(1).missing, 0U);
  EXPECT_EQ(image.counts(2).missing, 3U);
  EXPECT_EQ(image.counts(1).cycles, 4U);
}

/// Bits of it are no proof: FFFFh has those of both halves.
TEST_F(ProcessImageTest, ACounterThatIsNotTheExpectedOneIsWrong) {
  preset();
  ASSERT_TRUE(image.start(now));
  cycle();
  const auto old = image.input(1, kStatus)->time;
  unsigned missing = 0;
  for (const auto counter : std::initializer_list<std::uint16_t>{0, 1, 2, 4, 6, 7, 0xFFFF}) {
    says = counter;
    const auto written = image.set(1, kControl, hex("0700"));
    ASSERT_TRUE(written);
    cycle();
    EXPECT_FALSE(image.is_written(1, *written)) << counter;
    EXPECT_EQ(image.input(1, kStatus)->time, old) << counter;
    EXPECT_EQ(image.counts(1).missing, ++missing) << counter;
    EXPECT_EQ(image.counts(1).counter, counter);
    EXPECT_EQ(image.counts(1).expected, 3U);
  }
  says.reset();
  cycle();
  EXPECT_EQ(image.counts(1).missing, 0U);
  EXPECT_GT(image.input(1, kStatus)->time, old);
}

TEST_F(ProcessImageTest, ASlaveThatIsGoneDoesNotTouchTheOthers) {
  preset();
  ASSERT_TRUE(image.start(now));
  cycle();
  wire[0].gone = true;
  const auto old = image.input(1, kStatus)->time;
  for (int i = 0; i < 3; ++i) cycle();
  EXPECT_EQ(image.counts(1).missing, 3U);
  EXPECT_EQ(image.counts(2).missing, 0U);
  EXPECT_EQ(image.input(1, kStatus)->time, old);
  EXPECT_FALSE(image.fresh_input(1, kStatus, now)) << "more than two cycles old";
  EXPECT_TRUE(image.fresh_input(2, kStatus, now));
}

TEST_F(ProcessImageTest, InputsAreFreshForTwoCyclesAndNoLonger) {
  preset();
  ASSERT_TRUE(image.start(now));
  const auto sent = now;
  cycle();
  EXPECT_TRUE(image.fresh_input(1, kStatus, sent + 8ms));
  EXPECT_FALSE(image.fresh_input(1, kStatus, sent + 8ms + 1us));
  EXPECT_TRUE(image.fresh_input(1, kStatus, sent + 12ms, 3));
}

TEST_F(ProcessImageTest, LostFramesAreCountedAndNotRepeated) {
  preset();
  ASSERT_TRUE(image.start(now));
  for (int i = 0; i < 3; ++i) cycle(true);
  for (int i = 0; i < 6; ++i) cycle();
  EXPECT_EQ(image.counts(1).lost, 3U);
  EXPECT_EQ(image.counts(1).missing, 0U);
  EXPECT_EQ(ring.statistics().repeated, 0U);
  EXPECT_EQ(frames, 9);
}

TEST_F(ProcessImageTest, AFrameThatWasOvertakenBringsNothingOld) {
  preset();
  ASSERT_TRUE(image.start(now));
  wire[0].memory[0x1200] = 1;
  image.serve(ring, now);
  send();
  auto first = std::move(arriving);
  arriving.clear();
  wire[0].memory[0x1200] = 2;
  cycle();
  EXPECT_EQ(image.input(1, kStatus)->value[0], 2);
  for (const auto& frame : first) ring.on_frame(frame, now);
  image.serve(ring, now);
  EXPECT_EQ(image.input(1, kStatus)->value[0], 2);
  EXPECT_TRUE(image.is_written(1, 1));
}

TEST_F(ProcessImageTest, CyclesKeepTheirPhaseAndOnesThatWereMissedAreSkipped) {
  preset();
  ASSERT_TRUE(image.start(now));
  const auto begin = now;
  cycle();
  EXPECT_EQ(image.deadline(), begin + 4ms);
  now = begin + 4ms + 300us;
  cycle();
  EXPECT_EQ(image.deadline(), begin + 8ms);
  now = begin + 21ms;
  cycle();
  EXPECT_EQ(image.deadline(), begin + 24ms);
  EXPECT_EQ(image.rhythm().cycles, 3U);
  EXPECT_EQ(image.rhythm().skipped, 3U);
  EXPECT_EQ(image.rhythm().latest, 13ms);
}

TEST_F(ProcessImageTest, LongSilenceOfTheWireFillsNothing) {
  preset();
  ASSERT_TRUE(image.start(now));
  for (int i = 0; i < 1000; ++i) cycle(true);
  EXPECT_EQ(frames, 1000);
  EXPECT_GE(image.counts(1).lost, 990U);
  EXPECT_GE(image.counts(1).missing, 990U);
  for (int i = 0; i < 10; ++i) cycle();
  EXPECT_EQ(image.counts(1).missing, 0U);
}

}  // namespace
}  // namespace servoctl::ethercat
