#include "process_image_fixture.hpp"

#include <algorithm>

namespace servoctl::ethercat {
namespace {

using namespace std::chrono_literals;

TEST_F(ProcessImageTest, OutputsReachTheMemoryOfEachSlaveWhereTheyAreMapped) {
  preset();
  ASSERT_TRUE(image.start(now));
  cycle();
  EXPECT_EQ(output_memory(0), "06 00 78 56 34 12 31 00")
      << "a bit, three of a gap, the mode across two bytes";
  ASSERT_TRUE(image.set(2, kTarget, hex("01000000")));
  ASSERT_TRUE(image.set(2, kFlag, hex("00")));
  ASSERT_TRUE(image.set(2, kMode, hex("FF")));
  cycle();
  EXPECT_EQ(output_memory(0), "06 00 78 56 34 12 31 00");
  EXPECT_EQ(output_memory(1), "06 00 01 00 00 00 F0 0F");
}

TEST_F(ProcessImageTest, InputsComeByObject) {
  preset();
  ASSERT_TRUE(image.start(now));
  EXPECT_FALSE(image.input(1, kStatus)) << "before anything came";
  const auto bytes = hex("3712 01 04030201");
  std::copy(bytes.begin(), bytes.end(), wire[1].memory.begin() + 0x1200);
  const auto sent = now;
  cycle();
  EXPECT_EQ(to_hex(image.input(2, kStatus)->value), "37 12");
  EXPECT_EQ(to_hex(image.input(2, kBit)->value), "01");
  EXPECT_EQ(to_hex(image.input(2, kActual)->value), "04 03 02 01");
  EXPECT_EQ(image.input(2, kActual)->time, sent);
  EXPECT_EQ(to_hex(image.input(1, kStatus)->value), "00 00");
  EXPECT_FALSE(image.input(2, kTarget)) << "an output is no input";
  EXPECT_FALSE(image.input(3, kStatus)) << "no such node";
}

TEST_F(ProcessImageTest, NothingFlowsUntilEveryOutputWasSet) {
  ASSERT_TRUE(image.set(1, kControl, hex("0000")));
  const auto started = image.start(now);
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error().code, Errc::refused);
  EXPECT_EQ(started.error().message.text(),
            "node 1, object 0x607A:0: this output was never set, and the drive would obey a zero");
  EXPECT_EQ(image.unset(1), (std::vector<ObjectAddress>{kTarget, kFlag, kMode}));
  EXPECT_EQ(image.deadline(), kNever);
  cycle();
  EXPECT_EQ(frames, 0);
  preset();
  EXPECT_TRUE(image.start(now));
  EXPECT_TRUE(image.unset(1).empty());
}

TEST_F(ProcessImageTest, AValueOfAnotherLengthOrObjectIsRefused) {
  const auto longer = image.set(1, kControl, hex("060000"));
  ASSERT_FALSE(longer);
  EXPECT_EQ(longer.error().message.text(), "node 1, object 0x6040:0: 3 bytes for an output of 16 bits");
  EXPECT_EQ(image.set(1, kStatus, hex("0600")).error().message.text(),
            "node 1, object 0x6041:0: it is not among the outputs of the process image");
  EXPECT_FALSE(image.set(9, kControl, hex("0600")));
  EXPECT_FALSE(image.output(1, kControl));
  ASSERT_TRUE(image.set(1, kControl, hex("0F00")));
  EXPECT_EQ(to_hex(*image.output(1, kControl)), "0F 00");
  EXPECT_EQ(image.output_bits(1, kFlag), 1U);
  EXPECT_EQ(image.input_bits(1, kFlag), std::nullopt);
  EXPECT_EQ(image.input_bits(1, kActual), 32U);
}

TEST_F(ProcessImageTest, AWriteIsDoneWhenItsSlaveHasTakenIt) {
  preset();
  ASSERT_TRUE(image.start(now));
  cycle();
  const auto mark = image.set(1, kControl, hex("0F00")).value();
  EXPECT_FALSE(image.is_written(1, mark));
  wire[0].takes = false;
  cycle();
  EXPECT_FALSE(image.is_written(1, mark)) << "its counter was short";
  EXPECT_TRUE(image.is_written(2, mark));
  wire[0].takes = true;
  cycle(true);
  EXPECT_FALSE(image.is_written(1, mark)) << "its frame was lost";
  cycle();
  EXPECT_TRUE(image.is_written(1, mark));
  EXPECT_FALSE(image.is_written(9, mark));
}

TEST_F(ProcessImageTest, ValuesSetTogetherGoTogether) {
  preset();
  ASSERT_TRUE(image.start(now));
  const auto first = image.set(1, kTarget, hex("01000000")).value();
  EXPECT_EQ(image.set(1, kControl, hex("1F00")).value(), first);
  cycle();
  EXPECT_EQ(output_memory(0).substr(0, 17), "1F 00 01 00 00 00");
}

TEST_F(ProcessImageTest, BothSlavesRideInOneFrame) {
  preset();
  ASSERT_TRUE(image.start(now));
  cycle();
  cycle();
  EXPECT_EQ(frames, 2);
}

TEST_F(ProcessImageTest, WhatIsStoppedSendsNoMore) {
  preset();
  ASSERT_TRUE(image.start(now));
  cycle();
  image.stop();
  EXPECT_EQ(image.deadline(), kNever);
  EXPECT_FALSE(image.running());
  frames = 0;
  now += 1s;
  cycle();
  EXPECT_EQ(frames, 0);
  ASSERT_TRUE(image.start(now));
  image.serve(ring, now);
  image.leave(ring);
  EXPECT_FALSE(ring.take_frame(now)) << "it was not sent yet";
}

class ApartTest : public ProcessImageTest {
 protected:
  ApartTest() : ProcessImageTest(1, false) {}
};

TEST_F(ApartTest, ASlaveWithoutLrwIsReadAndWrittenApart) {
  preset();
  ASSERT_TRUE(image.start(now));
  wire[0].memory[0x1200] = 0x37;
  const auto mark = image.set(1, kControl, hex("0F00")).value();
  cycle();
  EXPECT_EQ(output_memory(0).substr(0, 5), "0F 00");
  EXPECT_EQ(image.input(1, kStatus)->value[0], 0x37);
  EXPECT_TRUE(image.is_written(1, mark));
  EXPECT_EQ(image.counts(1).missing, 0U);
  EXPECT_EQ(ring.statistics().short_counters, 0U);
  EXPECT_EQ(frames, 1);
  wire[0].gives = false;
  cycle();
  cycle();
  EXPECT_EQ(image.counts(1).short_inputs, 2U);
  EXPECT_EQ(image.counts(1).short_outputs, 0U);
  EXPECT_EQ(image.counts(1).missing, 2U);
}

TEST(ProcessImage, AnObjectThatIsMappedTwiceIsSetTwice) {
  ProcessImage image{ProcessImage::Options{}};
  image.add(1, {{{kControl, 16}, {kControl, 16}}, {}});
  ASSERT_TRUE(image.set(1, kControl, hex("0F00")));
  EXPECT_TRUE(image.unset(1).empty());
}

}  // namespace
}  // namespace servoctl::ethercat
