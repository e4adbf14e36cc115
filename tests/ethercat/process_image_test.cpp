#include "ethercat/process_image.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <deque>

#include "ethercat/bit_field.hpp"
#include "hex.hpp"
#include "process_slave.hpp"

namespace servoctl::ethercat {
namespace {

using namespace std::chrono_literals;

constexpr ObjectAddress kControl{0x6040, 0};
constexpr ObjectAddress kTarget{0x607A, 0};
constexpr ObjectAddress kMode{0x6060, 0};
constexpr ObjectAddress kFlag{0x2000, 1};
constexpr ObjectAddress kStatus{0x6041, 0};
constexpr ObjectAddress kActual{0x6064, 0};
constexpr ObjectAddress kBit{0x2001, 2};

ProcessMapping mapping() {
  return {{{kControl, 16}, {kTarget, 32}, {kFlag, 1}, {{0x0001, 0}, 3}, {kMode, 8}, {{0x0001, 0}, 4}},
          {{kStatus, 16}, {kBit, 1}, {{0x0001, 0}, 7}, {kActual, 32}}};
}

class ProcessImageTest : public testing::Test {
 protected:
  explicit ProcessImageTest(std::size_t slaves = 2, bool lrw = true) {
    for (std::size_t i = 0; i < slaves; ++i) {
      const auto number = static_cast<std::uint8_t>(i + 1);
      wire.emplace_back(static_cast<std::uint16_t>(0x1000 + number));
      const auto logical = image.add(number, mapping(), lrw);
      const auto plan = plan_slave(number, {2, 0x1100, 0x64, 3, 0x1200, 0x20}, mapping(), logical);
      for (const auto& request :
           plan->requests(SlaveAddress::station(static_cast<std::uint16_t>(0x1000 + number))))
        std::copy(request.data.begin(), request.data.end(),
                  wire.back().memory.begin() + (request.address >> 16));
    }
  }
  void preset() {
    for (std::uint8_t node = 1; node <= wire.size(); ++node) {
      ASSERT_TRUE(image.set(node, kControl, hex("0600")));
      ASSERT_TRUE(image.set(node, kTarget, hex("78563412")));
      ASSERT_TRUE(image.set(node, kFlag, hex("01")));
      ASSERT_TRUE(image.set(node, kMode, hex("03")));
    }
  }
  void send(bool lost = false) {
    while (const auto frame = ring.take_frame(now)) {
      ++frames;
      Bytes bytes(frame->begin(), frame->end());
      auto reader = FrameReader::open(*frame);
      while (const auto datagram = reader->next()) {
        unsigned counter = 0;
        for (auto& slave : wire) counter += slave.pass(*datagram, data_of(bytes, *datagram));
        set_working_counter(bytes, *datagram, static_cast<std::uint16_t>(counter));
      }
      if (!lost) arriving.push_back(std::move(bytes));
    }
  }
  void arrive() {
    for (; !arriving.empty(); arriving.pop_front()) ring.on_frame(arriving.front(), now);
    image.serve(ring, now);
  }
  /// One cycle to its end.
  void cycle(bool lost = false) {
    if (image.running()) now = std::max(now, image.deadline());
    ring.on_time(now);
    image.serve(ring, now);
    send(lost);
    now += 100us;
    arrive();
  }
  std::string output_memory(std::size_t slave) {
    return to_hex(ByteSpan(wire[slave].memory).subspan(0x1100, 8));
  }

  std::vector<ProcessSlave> wire;
  ProcessImage image{ProcessImage::Options{}};
  Ring ring{Ring::Options{}};
  TimePoint now{1s};
  std::deque<Bytes> arriving;
  int frames = 0;
};

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
  EXPECT_EQ(started.error().message,
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
  EXPECT_EQ(longer.error().message, "node 1, object 0x6040:0: 3 bytes for an output of 16 bits");
  EXPECT_EQ(image.set(1, kStatus, hex("0600")).error().message,
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

RC_GTEST_PROP(BitField, WhatIsWrittenIsReadAndNothingElseChanges, ()) {
  const auto at = *rc::gen::inRange<std::size_t>(0, 40);
  const auto bits = *rc::gen::inRange<std::size_t>(0, 33);
  const auto value = *rc::gen::container<Bytes>((bits + 7) / 8, rc::gen::arbitrary<std::uint8_t>());
  const auto before = *rc::gen::container<Bytes>(10, rc::gen::arbitrary<std::uint8_t>());
  auto image = before;
  write_bits(image, at, bits, value);
  Bytes read((bits + 7) / 8);
  read_bits(image, at, bits, read);
  for (std::size_t i = 0; i < 80; ++i) {
    const auto bit = [&](const Bytes& bytes, std::size_t n) { return bytes[n / 8] >> n % 8 & 1; };
    const bool inside = i >= at && i < at + bits;
    RC_ASSERT(bit(image, i) == (inside ? bit(value, i - at) : bit(before, i)));
    if (inside) RC_ASSERT(bit(read, i - at) == bit(value, i - at));
  }
  if (bits % 8 != 0) RC_ASSERT((read.back() >> bits % 8) == 0);
}

}  // namespace
}  // namespace servoctl::ethercat
