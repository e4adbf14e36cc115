#include "coe_wire.hpp"
#include "hex.hpp"

namespace servoctl::ethercat {
namespace {

using namespace std::chrono_literals;

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
  EXPECT_EQ(second.error().message.text(), "node 7, object 0x2000:1: its mailbox stays full");
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
  EXPECT_EQ(result.error().message.text(), "node 7, object 0x2000:1: no answer within 500 ms");
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
  EXPECT_EQ(result.error().message.text(), "node 7, object 0x2000:1: it does not answer at all");
}

}  // namespace
}  // namespace servoctl::ethercat
