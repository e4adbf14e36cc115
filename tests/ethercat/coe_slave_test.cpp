#include "ethercat/coe_slave.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <random>
#include <set>

#include "coe_server.hpp"
#include "hex.hpp"

namespace servoctl::ethercat {
namespace {

using namespace std::chrono_literals;

constexpr ObjectAddress kObject{0x2000, 1};

/// One slave with a mailbox and a server at the end of a wire, and what drives it. Time is virtual.
struct Wire {
  Wire(std::uint16_t out_size, std::uint16_t in_size, Duration timeout = 500ms)
      : place{0x1000, out_size, 0x1800, in_size},
        box(place),
        server(box, in_size),
        slave(7, SlaveAddress::station(0x1007), Mailbox::Options{place, 3}, timeout) {
    slave.mailbox().start(now);
  }

  /// Everything that can go without waiting, then the wait.
  void step() {
    slave.serve(ring, now);
    while (const auto frame = ring.take_frame(now)) pass(*frame);
    while (const auto emergency = slave.mailbox().take_emergency()) emergencies.push_back(emergency->code);
    slave.serve(ring, now);
    if (!arriving.empty()) {
      now += 30us;
      const auto frame = std::move(arriving.front());
      arriving.pop_front();
      ring.on_frame(frame, now);
      return;
    }
    const auto next = std::min({slave.deadline(), ring.deadline(), box.next()});
    if (next == kNever) return;
    now = std::max(now + 1us, next);
    box.run(now);
    ring.on_time(now);
    slave.on_time(now);
  }
  void pass(ByteSpan sent) {
    Bytes frame(sent.begin(), sent.end());
    const auto number = frames++;
    if (lost_out.count(number) != 0) return;
    auto reader = FrameReader::open(frame);
    ASSERT_TRUE(reader);
    while (const auto datagram = reader->next()) {
      EXPECT_EQ(datagram->adp(), 0x1007);
      box.run(now);
      const Request request{datagram->command, datagram->address,
                            Bytes(datagram->data.begin(), datagram->data.end()), false};
      set_working_counter(frame, *datagram, box.process(request, now));
      std::copy(box.data().begin(), box.data().end(), data_of(frame, *datagram).begin());
    }
    if (lost_back.count(number) == 0) arriving.push_back(frame);
  }

  Result<Bytes> finish() {
    const auto begin = now;
    for (int steps = 0; steps < 200'000; ++steps) {
      if (auto result = slave.client().take_result()) {
        EXPECT_FALSE(slave.client().take_result());
        return *result;
      }
      step();
    }
    ADD_FAILURE() << "no end after " << (now - begin).count() << " us";
    return fail(Errc::bug, "no end");
  }
  /// Asked again after silence, as whoever reads does.
  Result<Bytes> read(int tries = 1) {
    for (;; --tries) {
      slave.client().start_upload(kObject, now);
      auto result = finish();
      if (result || result.error().code != Errc::timeout || tries <= 1) return result;
    }
  }
  Result<Bytes> write(const Bytes& data) {
    slave.client().start_download(kObject, data, now);
    return finish();
  }
  void settle() {
    for (int i = 0; i < 60; ++i) step();
  }

  SiiMailbox place;
  MailboxSlave box;
  CoeServer server;
  Ring ring{Ring::Options{}};
  CoeSlave slave;
  TimePoint now{1s};
  std::deque<Bytes> arriving;
  std::set<int> lost_out;
  std::set<int> lost_back;
  int frames = 0;
  std::vector<std::uint16_t> emergencies;
};

Bytes pattern(std::size_t size) {
  Bytes out(size);
  for (std::size_t i = 0; i < size; ++i) out[i] = static_cast<std::uint8_t>(i * 7 + i / 256);
  return out;
}

Bytes emergency(std::uint16_t code) {
  return {0x00, 0x10, static_cast<std::uint8_t>(code), static_cast<std::uint8_t>(code >> 8), 0x81, 1, 2, 3,
          4,    5};
}

TEST(CoeSlave, ReadsAndWritesOverTheWire) {
  Wire wire(128, 128);
  for (const std::size_t size : {0U, 1U, 4U, 5U, 112U, 113U, 1000U}) {
    ASSERT_TRUE(wire.write(pattern(size))) << size;
    EXPECT_EQ(wire.read().value(), pattern(size)) << size;
  }
  EXPECT_EQ(wire.server.written.size(), 7U);
}

TEST(CoeSlave, AnExpeditedReadOnASlaveThatIsUpTakesFewFrames) {
  Wire wire(128, 128);
  wire.server.objects[{0x2000, 1}] = {1, 2};
  wire.box.latency = 0us;
  EXPECT_TRUE(wire.read());
  EXPECT_LE(wire.frames, 5) << "look, write, look, read";
  wire.frames = 0;
  EXPECT_TRUE(wire.read());
  EXPECT_LE(wire.frames, 3) << "write, look, read";
}

TEST(CoeSlave, ARequestThatNobodyWaitsForIsNotDoneLater) {
  Wire wire(64, 64);
  wire.box.stuck = true;
  EXPECT_FALSE(wire.write({1}));
  const auto second = wire.write({2});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().message, "node 7, object 0x2000:1: its mailbox stays full");
  wire.box.stuck = false;
  wire.settle();
  EXPECT_EQ(wire.server.written, (std::vector<Bytes>{{1}})) << "the first was in the mailbox already";
}

TEST(CoeSlave, TheAnswerToAnEarlierWriteDoesNotSayThatThisOneIsDone) {
  Wire wire(64, 64);
  // The first is done, and all frames that would bring its answer are lost until it is given up.
  for (int number = 0; number < 400; ++number) wire.lost_back.insert(number);
  wire.slave.mailbox().start(wire.now);
  wire.lost_back.erase(0);
  ASSERT_FALSE(wire.write({1}));
  ASSERT_EQ(wire.server.written.size(), 1U);
  wire.lost_back.clear();
  wire.server.refuses = 0x0800'0022;
  const auto second = wire.write({2});
  ASSERT_FALSE(second) << "it was refused: the answer to the first lay in the mailbox";
  EXPECT_EQ(second.error().abort_code, 0x0800'0022U);
  EXPECT_EQ(wire.server.objects[std::pair(0x2000U, 1U)], Bytes{1});
}

TEST(CoeSlave, AnAnswerThatCameAfterItsTimeIsNotThatOfTheNextRequest) {
  Wire wire(64, 64);
  auto coe = wire.box.handler;
  wire.box.handler = [](std::uint8_t, const Bytes&) {};
  ASSERT_FALSE(wire.write({1}));
  wire.settle();
  wire.box.handler = coe;
  wire.server.refuses = 0x0800'0022;
  wire.box.reply(3, hex("0030 60 002001 00000000"));
  const auto second = wire.write({2});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().abort_code, 0x0800'0022U);
}

TEST(CoeSlave, ARequestThatTimedOutInFrontOfAFullMailboxIsNotWrittenWhenThatIsFree) {
  Wire wire(64, 64, 100ms);
  wire.box.stuck = true;
  ASSERT_FALSE(wire.write({1}));
  const auto begin = wire.now;
  wire.slave.client().start_download(kObject, {2}, wire.now);
  while (wire.now < begin + 85ms) wire.step();
  // The look that would have ended the wait in time is lost; the next finds the mailbox free.
  wire.lost_out.insert(wire.frames);
  wire.lost_out.insert(wire.frames + 1);
  while (wire.now < begin + 95ms) wire.step();
  wire.box.stuck = false;
  const auto second = wire.finish();
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, Errc::timeout);
  wire.settle();
  EXPECT_EQ(wire.server.written, (std::vector<Bytes>{{1}}));
}

TEST(CoeSlave, AnAbandonedTransferIsAbortedAtTheSlave) {
  Wire wire(64, 64);
  wire.server.objects[{0x2000, 1}] = pattern(200);
  wire.slave.client().start_upload(kObject, wire.now);
  while (wire.slave.client().transferred() == 0) wire.step();
  wire.box.latency = 600ms;
  const auto result = wire.finish();
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().message, "node 7, object 0x2000:1: no answer within 500 ms");
  wire.box.latency = 0us;
  for (int i = 0; i < 5000 && wire.server.aborted == 0; ++i) wire.step();
  EXPECT_EQ(wire.server.aborted, 1);
}

TEST(CoeSlave, AQuestionForTheDictionaryRidesBesideATransfer) {
  Wire wire(64, 64);
  wire.server.objects[{0x2000, 1}] = pattern(300);
  wire.slave.client().start_upload(kObject, wire.now);
  auto coe = wire.box.handler;
  wire.box.handler = [&](std::uint8_t type, Bytes data) {
    if (data.at(1) == 0x80) return wire.box.reply(3, hex("0080 02000000 0100 0010 4160"));
    coe(type, std::move(data));
  };
  wire.slave.info().start_list(ObjectList::all, wire.now);
  EXPECT_EQ(wire.finish().value(), pattern(300));
  while (wire.slave.info().busy()) wire.step();
  const auto list = wire.slave.info().take_result();
  ASSERT_TRUE(list && *list);
  EXPECT_EQ(std::get<std::vector<std::uint16_t>>(**list), (std::vector<std::uint16_t>{0x1000, 0x6041}));
}

TEST(CoeSlave, ASlaveThatIsGoneEndsATransferWithThatReason) {
  Wire wire(64, 64);
  wire.box.gone = true;
  const auto result = wire.read();
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, Errc::timeout);
  EXPECT_EQ(result.error().message, "node 7, object 0x2000:1: it does not answer at all");
}

/// Sizes of both mailboxes and of the object, how the slave counts, how long it takes, what comes between.
struct Conditions {
  std::uint16_t out_size = *rc::gen::inRange<std::uint16_t>(16, 300);
  std::uint16_t in_size = *rc::gen::inRange<std::uint16_t>(16, 300);
  std::vector<std::uint8_t> numbers =
      *rc::gen::element(std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6, 7}, std::vector<std::uint8_t>{0},
                        std::vector<std::uint8_t>{3}, std::vector<std::uint8_t>{5, 0, 2, 2});
  Duration latency{*rc::gen::inRange(0, 8000)};
  bool drops_doubles = *rc::gen::arbitrary<bool>();
  std::uint8_t abort_service = *rc::gen::element<std::uint8_t>(2, 3);

  void put(Wire& wire) const {
    wire.box.numbers = numbers;
    wire.box.latency = latency;
    wire.box.drops_doubles = drops_doubles;
    wire.server.abort_service = abort_service;
  }
};

RC_GTEST_PROP(CoeSlave, EverySizeGoesThroughEveryMailbox, ()) {
  const Conditions conditions;
  Wire wire(conditions.out_size, conditions.in_size);
  conditions.put(wire);
  std::vector<std::uint16_t> told;
  for (int round = 0; round < 3; ++round) {
    const auto data = pattern(*rc::gen::inRange<std::size_t>(0, 700));
    for (int i = *rc::gen::inRange(0, 3); i > 0; --i) {
      told.push_back(static_cast<std::uint16_t>(0x8100 + told.size()));
      wire.server.before.push_back(emergency(told.back()));
    }
    const auto written = wire.write(data);
    RC_ASSERT(written);
    RC_ASSERT(wire.server.written.size() == static_cast<std::size_t>(round + 1));
    RC_ASSERT(wire.server.written.back() == data);
    const auto read = wire.read();
    RC_ASSERT(read);
    RC_ASSERT(*read == data);
  }
  while (!wire.server.before.empty()) RC_ASSERT(wire.read());
  wire.settle();
  RC_ASSERT(wire.emergencies == told);
  wire.server.refuses = 0x0601'0006;
  const auto refused = wire.read();
  RC_ASSERT(!refused);
  RC_ASSERT(refused.error().abort_code == 0x0601'0006U);
  RC_ASSERT(wire.server.aborted == 0);
}

RC_GTEST_PROP(CoeSlave, LostFramesLoseNoTruth, ()) {
  const Conditions conditions;
  Wire wire(conditions.out_size, conditions.in_size);
  conditions.put(wire);
  wire.box.repeats = *rc::gen::weightedElement<bool>({{4, true}, {1, false}});
  const auto every = *rc::gen::inRange(1, 40);
  std::mt19937 chance(*rc::gen::arbitrary<std::uint32_t>());
  for (int number = 0; number < 3000; ++number) {
    const auto fate = chance() % (2U * static_cast<unsigned>(every));
    if (fate > 1) continue;
    // Alone, or many in a row.
    const auto last = number + (chance() % 4 == 0 ? static_cast<int>(chance() % 40) : 0);
    for (; number <= last; ++number) (fate == 0 ? wire.lost_out : wire.lost_back).insert(number);
  }
  std::vector<std::uint16_t> told;
  wire.server.objects[{0x2000, 1}] = pattern(3);
  for (int round = 0; round < 4; ++round) {
    const auto data = pattern(*rc::gen::inRange<std::size_t>(0, 300));
    if (*rc::gen::arbitrary<bool>()) {
      told.push_back(static_cast<std::uint16_t>(0x8100 + told.size()));
      wire.server.before.push_back(emergency(told.back()));
    }
    const auto before = wire.server.written.size();
    wire.server.refuses = *rc::gen::weightedElement<std::uint32_t>({{3, 0U}, {1, 0x0800'0022U}});
    const auto written = wire.write(data);
    const auto times = wire.server.written.size() - before;
    RC_ASSERT(times <= 1U);
    if (written) RC_ASSERT(times == 1U);
    if (times == 1U) RC_ASSERT(wire.server.written.back() == data);
    RC_LOG() << (written ? "written" : written.error().message) << '\n';
    RC_ASSERT(written || written.error().code == Errc::timeout || written.error().abort_code == 0x0800'0022U);
    wire.server.refuses = 0;
    const auto present = wire.server.objects[{0x2000, 1}];
    const auto read = wire.read(5);
    if (read) RC_ASSERT(*read == present);
  }
  // What was told came once at most, and in its order.
  auto place = told.begin();
  for (const auto code : wire.emergencies) {
    place = std::find(place, told.end(), code);
    RC_ASSERT(place != told.end());
    ++place;
  }
}

}  // namespace
}  // namespace servoctl::ethercat
