#include "canopen/sdo_block.hpp"

#include <gtest/gtest.h>

#include <rapidcheck/gtest.h>

#include <algorithm>
#include <deque>

#include "canopen/sdo_abort.hpp"
#include "canopen/sdo_client.hpp"
#include "canopen/sdo_server.hpp"
#include "transcript.hpp"

namespace servoctl::canopen {
namespace {

using namespace std::chrono_literals;

Bytes counted(std::size_t size) {
  Bytes out(size);
  for (std::size_t i = 0; i < size; ++i) out[i] = static_cast<std::uint8_t>(i + 1);
  return out;
}

Bytes text(std::string_view words) { return {words.begin(), words.end()}; }

class OneObject final : public ObjectStore {
 public:
  std::uint32_t read(ObjectAddress, Bytes& out) override {
    out = value;
    return refusal;
  }
  std::uint32_t write(ObjectAddress, ByteSpan data) override {
    if (refusal == 0) value.assign(data.begin(), data.end());
    writes += refusal == 0;
    return refusal;
  }
  Bytes value;
  std::uint32_t refusal = 0;
  int writes = 0;
};

TEST(SdoCrc, HasTheCheckValueOfItsPolynomial) {
  EXPECT_EQ(sdo_crc(text("123456789")), 0x31C3);  // CiA 301, 7.2.4.3.16.
  EXPECT_EQ(sdo_crc({}), 0);
}

class BlockClientTest : public testing::Test {
 protected:
  void upload(std::initializer_list<std::string_view> lines, Transfer transfer = Transfer::domain) {
    client.start_upload({0x1F50, 1}, now, transfer);
    play(client, now, lines);
  }
  void download(Bytes data, std::initializer_list<std::string_view> lines,
                Transfer transfer = Transfer::block) {
    client.start_download({0x1F50, 1}, std::move(data), now, transfer);
    play(client, now, lines);
  }
  Result<Bytes> result() {
    auto first = client.take_result();
    EXPECT_TRUE(first) << "the transfer has not ended";
    EXPECT_FALSE(client.take_result()) << "two results";
    EXPECT_FALSE(client.busy());
    return first ? *first : Result<Bytes>(fail(Errc::bug, "none"));
  }
  void expect_failure(Errc code, std::string_view message) {
    const auto r = result();
    ASSERT_FALSE(r);
    EXPECT_EQ(r.error().code, code);
    EXPECT_EQ(r.error().message, "node 2, object 0x1F50:1: " + std::string(message));
  }
  SdoClient client{2, 500ms};
  TimePoint now{1s};
};

TEST_F(BlockClientTest, ReadsABlockAndChecksItsCrc) {
  upload({"> 602#A4501F017F000000", "< 582#C6501F0109000000", "> 602#A300000000000000",
          "< 582#0131323334353637", "< 582#8238390000000000", "> 602#A2027F0000000000",
          "< 582#D5C3310000000000", "> 602#A100000000000000"});
  EXPECT_EQ(result().value(), text("123456789"));
  upload({"> 602#A4501F017F000000", "< 582#C6501F0109000000", "> 602#A300000000000000",
          "< 582#0131323334353637", "< 582#8238390000000000", "> 602#A2027F0000000000",
          "< 582#D5C3320000000000", "> 602#80501F0104000405"});
  expect_failure(Errc::protocol, "the checksum of the block transfer is wrong");
}

TEST_F(BlockClientTest, LeavesTheCrcAloneWhenTheServerMakesNone) {
  upload({"> 602#A4501F017F000000", "< 582#C2501F0109000000", "> 602#A300000000000000",
          "< 582#0131323334353637", "< 582#8238390000000000", "> 602#A2027F0000000000",
          "< 582#D500000000000000", "> 602#A100000000000000"});
  EXPECT_EQ(result().value(), text("123456789"));
}

TEST_F(BlockClientTest, ReadsABlockOfUnknownLength) {
  upload({"> 602#A4501F017F000000", "< 582#C4501F0100000000", "> 602#A300000000000000",
          "< 582#8131320000000000", "> 602#A2017F0000000000", "< 582#D5B5200000000000",
          "> 602#A100000000000000"});
  EXPECT_EQ(result().value(), text("12"));
  upload({"> 602#A4501F017F000000", "< 582#C0501F0100000000", "> 602#A300000000000000",
          "< 582#8131320000000000", "> 602#A2017F0000000000", "< 582#D500000000000000",
          "> 602#A100000000000000"});
  EXPECT_EQ(result().value(), text("12"));
}

TEST_F(BlockClientTest, AsksAgainFromTheFirstSegmentThatWasLost) {
  upload({"> 602#A4501F017F000000", "< 582#C2501F0115000000", "> 602#A300000000000000",
          "< 582#0101010101010101", "< 582#8303030303030303", "> 602#A2017F0000000000",
          "< 582#0102020202020202", "< 582#8203030303030303", "> 602#A2027F0000000000",
          "< 582#C100000000000000", "> 602#A100000000000000"});
  EXPECT_EQ(result().value(), (Bytes{1, 1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2, 2, 3, 3, 3, 3, 3, 3, 3}));
}

TEST_F(BlockClientTest, AcknowledgesEarlyWhenTheEndOfABlockWasLost) {
  upload({"> 602#A4501F017F000000", "< 582#C2501F010E000000", "> 602#A300000000000000",
          "< 582#0101010101010101", "+ 250ms", "> 602#A2017F0000000000", "< 582#8102020202020202",
          "> 602#A2017F0000000000", "< 582#C100000000000000", "> 602#A100000000000000"});
  EXPECT_EQ(result().value().size(), 14U);
  upload({"> 602#A4501F017F000000", "< 582#C2501F010E000000", "> 602#A300000000000000",
          "< 582#0101010101010101", "+ 250ms", "> 602#A2017F0000000000", "+ 500ms",
          "> 602#80501F0100000405"});
  expect_failure(Errc::timeout, "no answer within 500 ms");
}

TEST_F(BlockClientTest, AsksEarlyOnlyOnceForTheSameBlock) {
  upload({"> 602#A4501F017F000000", "< 582#C2501F0115000000", "> 602#A300000000000000",
          "< 582#0101010101010101", "+ 250ms", "> 602#A2017F0000000000", "< 582#0102020202020202", "+ 499ms",
          "+ 1ms", "> 602#80501F0100000405"});
  expect_failure(Errc::timeout, "no answer within 500 ms");
}

TEST_F(BlockClientTest, IgnoresSegmentsThatComeTwice) {
  upload({"> 602#A4501F017F000000", "< 582#C2501F010E000000", "> 602#A300000000000000",
          "< 582#C2501F010E000000", "< 582#0101010101010101", "< 582#0101010101010101",
          "< 582#8202020202020202", "> 602#A2027F0000000000", "< 582#8202020202020202",
          "< 582#C100000000000000", "> 602#A100000000000000"});
  EXPECT_EQ(result().value(), (Bytes{1, 1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2, 2}));
}

TEST_F(BlockClientTest, UnderstandsAServerThatAnswersWithAnOrdinaryUpload) {
  upload({"> 602#A4501F017F000000", "< 582#4B501F0134120000"});
  EXPECT_EQ(result().value(), (Bytes{0x34, 0x12}));
  upload({"> 602#A4501F017F000000", "< 582#41501F0105000000", "> 602#6000000000000000",
          "< 582#0501020304050000"});
  EXPECT_EQ(result().value(), counted(5));
}

TEST_F(BlockClientTest, FallsBackToSegmentsWhenTheServerKnowsNoBlocks) {
  upload({"> 602#A4501F017F000000", "< 582#80501F0101000405", "> 602#40501F0100000000",
          "< 582#41501F0105000000", "> 602#6000000000000000", "< 582#0501020304050000"});
  EXPECT_EQ(result().value(), counted(5));
  download(counted(65), {"> 602#C6501F0141000000", "< 582#80501F0101000405", "> 602#21501F0141000000"},
           Transfer::automatic);
  client.on_frame(frame("582#80501F0100000008"), now);
  expect_failure(Errc::sdo_abort, "refused: general error (abort 0x08000000)");
}

TEST_F(BlockClientTest, DoesNotFallBackWhenTheObjectIsRefusedOrBlocksWereDemanded) {
  upload({"> 602#A4501F017F000000", "< 582#80501F0100000206"});
  expect_failure(Errc::sdo_abort,
                 "refused: object does not exist in the object dictionary (abort 0x06020000)");
  upload({"> 602#A4501F017F000000", "< 582#80501F0101000405"}, Transfer::block);
  EXPECT_EQ(result().error().code, Errc::sdo_abort);
}

TEST_F(BlockClientTest, WritesBlocksOfTheSizeTheServerAsksForInEveryAcknowledge) {
  download(counted(22), {"> 602#C6501F0116000000", "< 582#A0501F0102000000", "> 602#0101020304050607",
                         "> 602#0208090A0B0C0D0E", "< 582#A202010000000000", "> 602#010F101112131415",
                         "< 582#A201040000000000", "> 602#8116000000000000", "< 582#A201040000000000",
                         "> 602#D900000000000000", "< 582#A100000000000000"});
  EXPECT_TRUE(result());
}

TEST_F(BlockClientTest, EndsAWriteWithTheUnusedBytesAndTheCrc) {
  download(text("123456789"), {"> 602#C6501F0109000000", "< 582#A4501F017F000000", "> 602#0131323334353637",
                               "> 602#8238390000000000", "< 582#A2027F0000000000", "> 602#D5C3310000000000",
                               "< 582#A2027F0000000000", "< 582#A100000000000000"});
  EXPECT_TRUE(result());
  download(text("123456789"), {"> 602#C6501F0109000000", "< 582#A0501F017F000000", "> 602#0131323334353637",
                               "> 602#8238390000000000", "< 582#A2027F0000000000", "> 602#D500000000000000",
                               "< 582#A100000000000000"});
  EXPECT_TRUE(result());
  download({}, {"> 602#C6501F0100000000", "< 582#A0501F017F000000", "> 602#8100000000000000",
                "< 582#A2017F0000000000", "> 602#DD00000000000000", "< 582#A100000000000000"});
  EXPECT_TRUE(result());
}

TEST_F(BlockClientTest, SendsAgainWhatWasNotAcknowledged) {
  download(counted(21), {"> 602#C6501F0115000000", "< 582#A0501F017F000000", "> 602#0101020304050607",
                         "> 602#0208090A0B0C0D0E", "> 602#830F101112131415", "< 582#A2017F0000000000",
                         "> 602#0108090A0B0C0D0E", "> 602#820F101112131415", "< 582#A2007F0000000000",
                         "> 602#0108090A0B0C0D0E", "> 602#820F101112131415", "< 582#A2027F0000000000",
                         "> 602#C100000000000000", "< 582#A100000000000000"});
  EXPECT_TRUE(result());
}

TEST_F(BlockClientTest, RefusesAnImpossibleAcknowledge) {
  download(counted(9), {"> 602#C6501F0109000000", "< 582#A0501F017F000000", "> 602#0101020304050607",
                        "> 602#8208090000000000", "< 582#A2037F0000000000", "> 602#80501F0103000405"});
  expect_failure(Errc::protocol, "it acknowledged segment 3 and asked for blocks of 127");
  download(counted(9), {"> 602#C6501F0109000000", "< 582#A0501F017F000000", "> 602#0101020304050607",
                        "> 602#8208090000000000", "< 582#A201800000000000", "> 602#80501F0102000405"});
  expect_failure(Errc::protocol, "it acknowledged segment 1 and asked for blocks of 128");
  download(counted(9), {"> 602#C6501F0109000000", "< 582#A0501F0100000000", "> 602#80501F0102000405"});
  expect_failure(Errc::protocol, "it asks for blocks of 0 segments");
}

TEST_F(BlockClientTest, GivesUpOnAServerThatNeverGetsAnything) {
  download(counted(7), {"> 602#C6501F0107000000", "< 582#A0501F017F000000", "> 602#8101020304050607"});
  for (int i = 0; i < 9; ++i) play(client, now, {"< 582#A2007F0000000000", "> 602#8101020304050607"});
  play(client, now, {"< 582#A2007F0000000000", "> 602#80501F0103000405"});
  expect_failure(Errc::protocol, "it acknowledged segment 0 and asked for blocks of 127");
}

TEST_F(BlockClientTest, WaitsFromTheEndOfTheBlockAndNotFromItsBegin) {
  client.start_download({0x1F50, 1}, counted(9), now, Transfer::block);
  (void)client.take_frame();
  client.on_frame(frame("582#A0501F0101000000"), now);
  EXPECT_EQ(client.deadline(), kNever);
  now += 2s;
  play(client, now, {"> 602#0101020304050607", "+ 0ms", "+ 499ms"});
  EXPECT_TRUE(client.busy());
  play(client, now, {"+ 1ms", "> 602#80501F0100000405"});
  expect_failure(Errc::timeout, "no answer within 500 ms");
}

TEST_F(BlockClientTest, TakesAnAbortInTheMiddleOfABlock) {
  upload({"> 602#A4501F017F000000", "< 582#C2501F010E000000", "> 602#A300000000000000",
          "< 582#0101010101010101", "< 582#80501F0120000008"});
  EXPECT_EQ(result().error().abort_code, 0x0800'0020U);
}

TEST_F(BlockClientTest, RefusesMoreOrLessThanAnnounced) {
  upload({"> 602#A4501F017F000000", "< 582#C2501F010E000000", "> 602#A300000000000000",
          "< 582#8101010101010101", "> 602#A2017F0000000000", "< 582#C100000000000000",
          "> 602#80501F0110000706"});
  expect_failure(Errc::protocol, "it announced 14 bytes and sent 7");
  upload({"> 602#A4501F017F000000", "< 582#C2501F0101000000", "> 602#A300000000000000",
          "< 582#0101010101010101", "< 582#0201010101010101", "> 602#80501F0110000706"});
  expect_failure(Errc::protocol, "it sends more than the 1 bytes it announced");
}

class BlockServerTest : public testing::Test {
 protected:
  OneObject object;
  SdoServer server{2, object, {}};
  TimePoint now{1s};
};

TEST_F(BlockServerTest, GivesABlock) {
  object.value = text("123456789");
  play(server, now,
       {"< 602#A4501F017F000000", "> 582#C6501F0109000000", "< 602#A300000000000000",
        "> 582#0131323334353637", "> 582#8238390000000000", "< 602#A2027F0000000000",
        "> 582#D5C3310000000000", "< 602#A100000000000000"});
  EXPECT_EQ(server.deadline(), kNever);
}

TEST_F(BlockServerTest, AnswersOrdinarilyBelowTheSwitchThreshold) {
  object.value = {1, 2};
  play(server, now, {"< 602#A4501F017F020000", "> 582#4B501F0101020000"});
}

TEST_F(BlockServerTest, TakesABlockAndWritesOnce) {
  play(server, now,
       {"< 602#C6501F0109000000", "> 582#A4501F017F000000", "< 602#0131323334353637",
        "< 602#8238390000000000", "> 582#A2027F0000000000", "< 602#8238390000000000",
        "< 602#D5C3310000000000", "> 582#A100000000000000"});
  EXPECT_EQ(object.value, text("123456789"));
  EXPECT_EQ(object.writes, 1);
}

TEST_F(BlockServerTest, RefusesAWrongCrcAWrongSizeAndItsObject) {
  play(
      server, now,
      {"< 602#C6501F0109000000", "> 582#A4501F017F000000", "< 602#0131323334353637", "< 602#8238390000000000",
       "> 582#A2027F0000000000", "< 602#D5C3320000000000", "> 582#80501F0104000405"});
  play(
      server, now,
      {"< 602#C2501F010A000000", "> 582#A4501F017F000000", "< 602#0131323334353637", "< 602#8238390000000000",
       "> 582#A2027F0000000000", "< 602#D500000000000000", "> 582#80501F0113000706"});
  object.refusal = sdo_abort::kReadOnly;
  play(
      server, now,
      {"< 602#C2501F0109000000", "> 582#A4501F017F000000", "< 602#0131323334353637", "< 602#8238390000000000",
       "> 582#A2027F0000000000", "< 602#D500000000000000", "> 582#80501F0102000106"});
  EXPECT_EQ(object.writes, 0);
}

TEST_F(BlockServerTest, RefusesBlocksWhenItHasNone) {
  SdoServer::Options options;
  options.block = false;
  SdoServer plain(2, object, options);
  play(plain, now, {"< 602#A4501F017F000000", "> 582#80501F0101000405"});
  play(plain, now, {"< 602#C6501F0109000000", "> 582#80501F0101000405"});
}

TEST_F(BlockServerTest, GivesUpWhenTheClientFallsSilent) {
  object.value = counted(20);
  play(
      server, now,
      {"< 602#A4501F017F000000", "> 582#C6501F0114000000", "< 602#A300000000000000", "> 582#0101020304050607",
       "> 582#0208090A0B0C0D0E", "> 582#830F101112131400", "+ 0ms", "+ 1s", "> 582#80501F0100000405"});
}

TEST_F(BlockServerTest, GivesTheClientItsFullTimeForEveryAnswer) {
  object.value = text("123456789");
  play(server, now,
       {"< 602#A4501F017F000000", "> 582#C6501F0109000000", "+ 900ms", "< 602#A300000000000000",
        "> 582#0131323334353637", "> 582#8238390000000000", "+ 0ms", "+ 900ms", "< 602#A2027F0000000000",
        "> 582#D5C3310000000000", "+ 999ms", "+ 1ms", "> 582#80501F0100000405"});
  play(server, now,
       {"< 602#C6501F0109000000", "> 582#A4501F017F000000", "+ 999ms", "+ 1ms", "> 582#80501F0100000405"});
}

/// A client and a server with a line between them that loses and doubles frames.
class Line {
 public:
  Line(OneObject& object, SdoServer::Options options) : server(2, object, options) {}

  /// Runs until the client has its result; `fate` says for each frame how many copies arrive.
  template <class Fate>
  Result<Bytes> run(Fate fate) {
    for (int round = 0; round < 200'000; ++round) {
      bool moved = false;
      while (const auto sent = client.take_frame()) {
        moved = true;
        for (int copies = fate(); copies > 0; --copies) server.on_frame(*sent, now);
      }
      while (const auto sent = server.take_frame()) {
        moved = true;
        for (int copies = fate(); copies > 0; --copies) client.on_frame(*sent, now);
      }
      if (auto result = client.take_result()) return std::move(*result);
      if (moved) continue;
      now = std::max(now, std::min(client.deadline(), server.deadline()));
      client.on_time(now);
      server.on_time(now);
    }
    return fail(Errc::bug, "it never ends");
  }

  SdoClient client{2, 500ms};
  SdoServer server;
  TimePoint now{1s};
};

RC_GTEST_PROP(BlockTransfer, CarriesAnyDataInAnyBlockSize, ()) {
  const auto data = *rc::gen::container<Bytes>(rc::gen::arbitrary<std::uint8_t>());
  SdoServer::Options options;
  options.block_size = *rc::gen::inRange<std::uint8_t>(1, 128);
  options.crc = *rc::gen::arbitrary<bool>();
  OneObject object;
  Line line(object, options);
  line.client.start_download({0x1F50, 1}, data, line.now, Transfer::block);
  RC_ASSERT(line.run([] { return 1; }).has_value());
  RC_ASSERT(object.value == data);
  line.client.start_upload({0x1F50, 1}, line.now, Transfer::block);
  const auto read = line.run([] { return 1; });
  RC_ASSERT(read.has_value());
  RC_ASSERT(*read == data);
}

TEST(BlockTransfer, GetsOverTheLossOfAnySingleSegment) {
  for (int lost = 0; lost < 100; ++lost) {
    OneObject object;
    Line line(object, {});
    int segment =
        -3;  // Request and answer go before the first segment of a write; the start too before one of a read.
    const auto fate = [&] { return segment++ == lost ? 0 : 1; };
    line.client.start_upload({0x1F50, 1}, line.now, Transfer::block);
    object.value = counted(700);
    const auto read = line.run(fate);
    ASSERT_TRUE(read) << lost << ": " << read.error().message;
    EXPECT_EQ(*read, counted(700));
    segment = -2;
    line.client.start_download({0x1F50, 1}, counted(700), line.now, Transfer::block);
    ASSERT_TRUE(line.run(fate)) << lost;
    EXPECT_EQ(object.value, counted(700));
  }
}

RC_GTEST_PROP(BlockTransfer, NeverDeliversWrongDataOverALineThatLosesAndDoublesFrames, ()) {
  const auto size = *rc::gen::inRange<std::size_t>(0, 3000);
  Bytes data(size);
  for (std::size_t i = 0; i < size; ++i) data[i] = static_cast<std::uint8_t>(i * 31 + i / 256);
  auto seed = *rc::gen::inRange<std::uint32_t>(1, 1'000'000);
  const auto one_in = *rc::gen::inRange<std::uint32_t>(5, 400);
  const auto fate = [&] {
    seed = seed * 1664525U + 1013904223U;
    const auto draw = (seed >> 8U) % one_in;
    return draw == 0 ? 0 : draw == 1 ? 2 : 1;
  };
  SdoServer::Options options;
  options.block_size = *rc::gen::inRange<std::uint8_t>(1, 128);
  OneObject object;
  Line line(object, options);
  line.client.start_download({0x1F50, 1}, data, line.now, Transfer::block);
  const auto written = line.run(fate);
  RC_ASSERT(!written.has_value() || object.value == data);
  RC_ASSERT(written.has_value() || written.error().code != Errc::bug);
  object.value = data;
  line.server.reset();
  (void)line.client.take_frame();
  line.client.start_upload({0x1F50, 1}, line.now, Transfer::block);
  const auto read = line.run(fate);
  RC_ASSERT(!read.has_value() || *read == data);
  RC_ASSERT(read.has_value() || read.error().code != Errc::bug);
}

}  // namespace
}  // namespace servoctl::canopen
