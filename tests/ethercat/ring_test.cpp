#include "ethercat/ring.hpp"

#include <gtest/gtest.h>

#include "ethercat/registers.hpp"
#include "hex.hpp"

namespace servoctl::ethercat {
namespace {

using namespace std::chrono_literals;

/// A wire of slaves that answer every datagram: reads bring 5Ah, the counter says 1.
Bytes answered(ByteSpan frame, std::uint16_t counter = 1) {
  Bytes out(frame.begin(), frame.end());
  out[6] |= 0x02;  // The first slave marks the source address.
  auto reader = FrameReader::open(frame);
  while (const auto datagram = reader->next()) {
    if (reads(datagram->command))
      for (auto& byte : data_of(out, *datagram)) byte = 0x5A;
    set_working_counter(out, *datagram, counter);
  }
  return out;
}

std::vector<Datagram> parts_of(ByteSpan frame) {
  std::vector<Datagram> out;
  auto reader = FrameReader::open(frame);
  while (const auto datagram = reader->next()) out.push_back(*datagram);
  return out;
}

class RingTest : public testing::Test {
 protected:
  Bytes sent() {
    const auto frame = ring.take_frame(now);
    EXPECT_TRUE(frame);
    return frame ? Bytes(frame->begin(), frame->end()) : Bytes{};
  }
  Ring::Ticket post(Request request) { return ring.post(request).value(); }
  Ring::Ticket read(std::uint16_t where, std::size_t size = 2) {
    return post(read_registers(slave, where, size));
  }

  SlaveAddress slave = SlaveAddress::station(0x1001);
  Ring ring{Ring::Options{}};
  TimePoint now{1s};
};

TEST_F(RingTest, AnAnswerComesToWhoAsked) {
  const auto ticket = read(reg::kAlStatus);
  EXPECT_FALSE(ring.take_answer(ticket));
  const auto frame = sent();
  EXPECT_FALSE(ring.take_frame(now));
  EXPECT_EQ(ring.deadline(), now + 20ms);
  EXPECT_TRUE(ring.on_frame(answered(frame), now + 1ms));
  const auto answer = ring.take_answer(ticket);
  ASSERT_TRUE(answer);
  EXPECT_TRUE(answer->done());
  EXPECT_EQ(to_hex(answer->data), "5A 5A");
  EXPECT_EQ(answer->sent, now);
  EXPECT_FALSE(ring.take_answer(ticket)) << "once";
  EXPECT_EQ(ring.deadline(), kNever);
}

TEST_F(RingTest, WhatTheSlaveDoesNotCountIsSentAgainLikeWhatIsLost) {
  const auto ticket = read(reg::kAlStatus);
  ring.on_frame(answered(sent(), 0), now);
  EXPECT_FALSE(ring.take_answer(ticket));
  ring.on_frame(answered(sent(), 1), now);
  EXPECT_TRUE(ring.take_answer(ticket).value().done());
  const auto nobody = read(reg::kAlStatus);
  for (int times = 0; times < 3; ++times) ring.on_frame(answered(sent(), 0), now);
  const auto answer = ring.take_answer(nobody);
  ASSERT_TRUE(answer) << "not for ever";
  EXPECT_FALSE(answer->lost);
  EXPECT_EQ(answer->working_counter, 0);
  EXPECT_EQ(ring.statistics().repeated, 3U);
}

TEST_F(RingTest, WhatMustNotBeDoneTwiceAndWhatConcernsAllIsNotSentAgainWhenNobodyCountsIt) {
  const auto once = post(write_once(slave, 0x1000, {1}));
  const auto all = post({Command::brd, physical_address(0, reg::kAlStatus), Bytes(2), true});
  ring.on_frame(answered(sent(), 0), now);
  EXPECT_FALSE(ring.take_answer(once).value().done());
  EXPECT_FALSE(ring.take_answer(all).value().done());
  EXPECT_FALSE(ring.take_frame(now));
}

TEST_F(RingTest, WhatIsPostedTogetherGoesInOneFrame) {
  const auto first = read(reg::kAlStatus);
  const auto second = read(reg::kStationAlias);
  const auto frame = sent();
  ASSERT_EQ(parts_of(frame).size(), 2U);
  EXPECT_NE(parts_of(frame)[0].index, parts_of(frame)[1].index);
  EXPECT_FALSE(ring.take_frame(now));
  ring.on_frame(answered(frame), now);
  EXPECT_TRUE(ring.take_answer(second));
  EXPECT_TRUE(ring.take_answer(first));
  EXPECT_EQ(ring.statistics().sent, 1U);
  EXPECT_EQ(ring.statistics().received, 1U);
}

TEST_F(RingTest, WhatDoesNotFitGoesInTheNextFrameAndAnswersMayComeInAnyOrder) {
  const auto first = read(0x1000, 1000);
  const auto second = read(0x1400, 1000);
  const auto frame = sent();
  const auto next = sent();
  ring.on_frame(answered(next), now);
  EXPECT_FALSE(ring.take_answer(first));
  EXPECT_TRUE(ring.take_answer(second));
  ring.on_frame(answered(frame), now);
  EXPECT_TRUE(ring.take_answer(first));
}

TEST_F(RingTest, SoManyFramesAreUnderWayAtOnceAndNoMore) {
  std::vector<Ring::Ticket> tickets;
  for (int i = 0; i < 6; ++i) tickets.push_back(read(0x1000, 1400));
  std::vector<Bytes> frames;
  for (int i = 0; i < 4; ++i) frames.push_back(sent());
  EXPECT_FALSE(ring.take_frame(now));
  Ring::Post urgent;
  urgent.urgent = true;
  const auto cycle = ring.post(Command::lrw, 0, Bytes(10), urgent).value();
  const auto urgent_frame = sent();
  EXPECT_EQ(parts_of(urgent_frame).front().command, Command::lrw) << "what is urgent does not wait";
  ring.on_frame(answered(urgent_frame), now);
  EXPECT_TRUE(ring.take_answer(cycle));
  ring.on_frame(answered(frames[2]), now);
  EXPECT_TRUE(ring.take_frame(now));
  EXPECT_FALSE(ring.take_frame(now));
}

TEST_F(RingTest, WhatIsUrgentGoesFirstAndOthersRideAlong) {
  read(reg::kAlStatus);
  Ring::Post urgent;
  urgent.urgent = true;
  ring.post(Command::lrw, 0, Bytes(10), urgent);
  const auto asked = parts_of(sent());
  ASSERT_EQ(asked.size(), 2U);
  EXPECT_EQ(asked[0].command, Command::lrw);
  EXPECT_EQ(asked[1].command, Command::fprd);
}

TEST_F(RingTest, WhatMayBeRepeatedIsAndThenLost) {
  const auto ticket = read(reg::kAlStatus);
  for (int tries = 0; tries < 3; ++tries) {
    EXPECT_EQ(parts_of(sent()).size(), 1U);
    ring.on_time(now + 19ms);
    EXPECT_FALSE(ring.take_frame(now));
    now += 20ms;
    ring.on_time(now);
  }
  EXPECT_FALSE(ring.take_frame(now));
  const auto answer = ring.take_answer(ticket);
  ASSERT_TRUE(answer);
  EXPECT_TRUE(answer->lost);
  EXPECT_FALSE(answer->done());
  EXPECT_EQ(ring.statistics().lost, 3U);
  EXPECT_EQ(ring.statistics().repeated, 2U);
}

TEST_F(RingTest, WhatMustNotBeDoneTwiceIsSentOnce) {
  const auto ticket = post(write_once(slave, 0x1000, Bytes(128)));
  sent();
  now += 20ms;
  ring.on_time(now);
  EXPECT_FALSE(ring.take_frame(now));
  EXPECT_TRUE(ring.take_answer(ticket)->lost);
}

TEST_F(RingTest, AnAnswerBehindItsTimeIsNobodys) {
  const auto ticket = post(write_once(slave, 0x1000, Bytes(8)));
  const auto frame = sent();
  now += 20ms;
  ring.on_time(now);
  EXPECT_TRUE(ring.take_answer(ticket)->lost);
  const auto next = post(write_once(slave, 0x1000, Bytes(8)));
  sent();
  EXPECT_FALSE(ring.on_frame(answered(frame), now));
  EXPECT_EQ(ring.statistics().late, 1U);
  EXPECT_FALSE(ring.take_answer(next)) << "the index was not used again at once";
}

TEST_F(RingTest, AnAnswerToSomethingElseIsNobodys) {
  const auto ticket = read(reg::kAlStatus);
  const auto frame = answered(sent());
  auto other = frame;
  other[16] = static_cast<std::uint8_t>(Command::fpwr);
  EXPECT_FALSE(ring.on_frame(other, now));
  other = frame;
  other[18] = 0x02;  // Another station.
  EXPECT_FALSE(ring.on_frame(other, now));
  other = frame;
  other[20] = 0x10;  // Another register.
  EXPECT_FALSE(ring.on_frame(other, now));
  other = frame;
  other[17] = 99;  // An index that nobody has.
  EXPECT_FALSE(ring.on_frame(other, now));
  other = frame;
  other[22] = 1;  // Another length.
  EXPECT_FALSE(ring.on_frame(other, now));
  EXPECT_EQ(ring.statistics().late, 5U);
  EXPECT_FALSE(ring.take_answer(ticket));
  EXPECT_TRUE(ring.on_frame(frame, now));
  EXPECT_FALSE(ring.on_frame(frame, now)) << "twice";
  EXPECT_TRUE(ring.take_answer(ticket));
}

TEST_F(RingTest, APositionIsCountedUpByTheSlavesAndKnownAllTheSame) {
  const auto ticket = post(read_registers(SlaveAddress::at_position(2), reg::kType, 1));
  auto frame = sent();
  EXPECT_EQ(parts_of(frame)[0].adp(), 0xFFFE);
  set_address(frame, parts_of(frame)[0], physical_address(3, reg::kType));
  EXPECT_TRUE(ring.on_frame(answered(frame), now));
  EXPECT_TRUE(ring.take_answer(ticket)->done());
}

TEST_F(RingTest, ACounterThatIsShortIsCounted) {
  Ring::Post how;
  how.expected = 3;
  const auto ticket = ring.post(Command::lrw, 0, Bytes(4), how).value();
  ring.on_frame(answered(sent(), 2), now);
  EXPECT_EQ(ring.take_answer(ticket)->working_counter, 2);
  EXPECT_EQ(ring.statistics().short_counters, 1U);
}

TEST_F(RingTest, DamagedAndForeignFramesAreLeftAlone) {
  const auto ticket = read(reg::kAlStatus);
  auto frame = answered(sent());
  frame[22] = 0xFF;
  EXPECT_FALSE(ring.on_frame(frame, now));
  EXPECT_EQ(ring.statistics().damaged, 1U);
  EXPECT_FALSE(ring.on_frame(Bytes(60), now));
  EXPECT_EQ(ring.statistics().damaged, 1U);
  EXPECT_FALSE(ring.take_answer(ticket));
}

TEST_F(RingTest, WhatIsForgottenGivesItsPlaceBackWhereverItIs) {
  for (int round = 0; round < 300; ++round) {
    const auto queued = read(reg::kAlStatus);
    ring.forget(queued);
    EXPECT_FALSE(ring.take_frame(now));
    const auto flying = read(reg::kAlStatus);
    const auto frame = sent();
    ring.forget(flying);
    ring.on_frame(answered(frame), now);
    EXPECT_FALSE(ring.take_answer(flying));
    const auto answered_one = read(reg::kAlStatus);
    ring.on_frame(answered(sent()), now);
    ring.forget(answered_one);
  }
}

TEST_F(RingTest, WhenAllPlacesAreTakenNothingMoreIs) {
  for (int i = 0; i < 256; ++i) EXPECT_TRUE(ring.post(read_registers(slave, 0, 1)));
  EXPECT_FALSE(ring.post(read_registers(slave, 0, 1)));
  EXPECT_FALSE(Ring(Ring::Options{}).post(Command::fpwr, 0, Bytes(kMaxDatagramData + 1), {}));
}

/// Counts up as long as it is answered.
struct Counter {
  int left = 3;
  std::vector<std::uint16_t> counters;
  std::optional<Request> take_request() {
    if (left == 0) return std::nullopt;
    --left;
    return read_registers(SlaveAddress::station(1), reg::kType, 1);
  }
  void on_answer(const Answer& answer, TimePoint) { counters.push_back(answer.working_counter); }
};

TEST_F(RingTest, ACarrierTakesRequestsOfAMachineOneByOne) {
  Counter machine;
  Carrier carrier;
  while (carrier.serve(machine, ring, now)) {
    const auto frame = ring.take_frame(now);
    if (!frame) break;
    EXPECT_EQ(parts_of(*frame).size(), 1U);
    EXPECT_FALSE(carrier.serve(machine, ring, now)) << "while one is under way";
    ring.on_frame(answered(*frame, 7), now);
    EXPECT_TRUE(carrier.serve(machine, ring, now)) << "the answer";
  }
  EXPECT_EQ(machine.counters, (std::vector<std::uint16_t>{7, 7, 7}));
  machine.left = 1;
  carrier.serve(machine, ring, now);
  carrier.leave(ring);
  EXPECT_FALSE(ring.take_frame(now));
}

}  // namespace
}  // namespace servoctl::ethercat
