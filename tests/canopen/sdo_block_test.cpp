#include "canopen/sdo_block.hpp"

#include <gtest/gtest.h>

#include "canopen/sdo_abort.hpp"
#include "canopen/sdo_client.hpp"
#include "one_object.hpp"
#include "transcript.hpp"

namespace servoctl::canopen {
namespace {

using namespace std::chrono_literals;

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
    EXPECT_EQ(r.error().message.text(), "node 2, object 0x1F50:1: " + std::string(message));
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

TEST_F(BlockClientTest, TakesLessThanAnnouncedAndRefusesMore) {
  upload({"> 602#A4501F017F000000", "< 582#C2501F010E000000", "> 602#A300000000000000",
          "< 582#8101010101010101", "> 602#A2017F0000000000", "< 582#C100000000000000",
          "> 602#A100000000000000"});
  EXPECT_EQ(client.take_result().value().value(), Bytes(7, 1));
  EXPECT_TRUE(client.take_habits().test(static_cast<std::size_t>(SdoHabit::announced_more)));
  upload({"> 602#A4501F017F000000", "< 582#C2501F0101000000", "> 602#A300000000000000",
          "< 582#0101010101010101", "< 582#0201010101010101", "> 602#80501F0110000706"});
  expect_failure(Errc::protocol, "it sends more than the 1 bytes it announced");
}

}  // namespace
}  // namespace servoctl::canopen
