// The client's block transfers at their edges; sdo_block_test.cpp has their course.
#include "canopen/sdo_client.hpp"
#include "transcript.hpp"

namespace servoctl::canopen {
namespace {

using namespace std::chrono_literals;

class ClientBlockTest : public testing::Test {
 protected:
  using Lines = std::initializer_list<std::string_view>;
  /// Each of these must send what stands behind it and nothing else.
  void steps(std::initializer_list<Lines> all) {
    for (const auto& lines : all) play(client, now, lines);
  }
  void upload(std::initializer_list<Lines> all) {
    client.start_upload({0x2000, 1}, now, Transfer::domain);
    steps(all);
  }
  void download(std::size_t size, std::initializer_list<Lines> all) {
    Bytes data(size);
    for (std::size_t i = 0; i < size; ++i) data[i] = static_cast<std::uint8_t>(i + 1);
    client.start_download({0x2000, 1}, std::move(data), now, Transfer::block);
    steps(all);
  }
  std::string outcome() {
    const auto r = client.take_result();
    EXPECT_TRUE(r) << "the transfer has not ended";
    EXPECT_EQ(client.deadline(), kNever);
    constexpr std::string_view kStart = "node 2, object 0x2000:1: ";
    return !r ? "" : *r ? std::to_string((*r)->size()) : r->error().message.text().substr(kStart.size());
  }
  SdoClient client{2, 500ms};
  TimePoint now{1s};
};

TEST_F(ClientBlockTest, AsksForALostEndOnceInEveryBlock) {
  for (int times = 0; times < 2; ++times) {
    upload({{"> 602#A40020017F000000", "< 582#C20020011C000000", "> 602#A300000000000000"},
            {"< 582#0101010101010101"},
            {"+ 249ms"},
            {"+ 1ms", "> 602#A2017F0000000000"},
            {"< 582#0102020202020202"},
            {"< 582#8304040404040404", "> 602#A2017F0000000000"},
            {"< 582#0103030303030303"},
            {"+ 249ms"},
            {"+ 1ms", "> 602#A2017F0000000000"},
            {"< 582#0104040404040404"},
            {"+ 499ms"},
            {"+ 1ms", "> 602#8000200100000405"}});
    EXPECT_EQ(outcome(), "no answer within 500 ms");
  }
}

TEST_F(ClientBlockTest, ReadsAnEmptyDomainInSegments) {
  upload({{"> 602#A40020017F000000", "< 582#C200200100000000", "> 602#8000200100000008",
           "> 602#4000200100000000"},
          {"< 582#4100200100000000", "> 602#6000000000000000", "< 582#0F00000000000000"}});
  EXPECT_EQ(outcome(), "0");
}

TEST_F(ClientBlockTest, EndsAtOnceWhenTheNodeRestartsWhileSegmentsAreSent) {
  download(9, {{"> 602#C600200109000000", "< 582#A40020017F000000", "> 602#0101020304050607",
                "> 602#8208090000000000", "< 702#00"}});
  EXPECT_EQ(outcome(), "the node restarted (boot-up) in the middle of the transfer");
}

TEST_F(ClientBlockTest, WaitsForTheFirstSegmentAllItsTime) {
  upload({{"> 602#A40020017F000000", "< 582#C20020011C000000", "> 602#A300000000000000"},
          {"+ 499ms"},
          {"+ 1ms", "> 602#8000200100000405"}});
  EXPECT_EQ(outcome(), "no answer within 500 ms");
}

TEST_F(ClientBlockTest, TakesAnEmptySegmentAfterTheLastByteAndNoMore) {
  upload({{"> 602#A40020017F000000", "< 582#C200200107000000", "> 602#A300000000000000"},
          {"< 582#0101020304050607"},
          {"< 582#8200000000000000", "> 602#A2027F0000000000"},
          {"< 582#DD00000000000000", "> 602#A100000000000000"}});
  EXPECT_EQ(outcome(), "7");
  upload({{"> 602#A40020017F000000", "< 582#C200200106000000", "> 602#A300000000000000"},
          {"< 582#0101020304050607"},
          {"< 582#8200000000000000", "> 602#8000200110000706"}});
  EXPECT_EQ(outcome(), "it sends more than the 6 bytes it announced");
  upload({{"> 602#A40020017F000000", "< 582#C200200106000000", "> 602#A300000000000000"},
          {"< 582#8101020304050607", "> 602#A2017F0000000000"},
          {"< 582#C100000000000000", "> 602#8000200110000706"}});
  EXPECT_EQ(outcome(), "it announced 6 bytes and sent 7");
}

TEST_F(ClientBlockTest, ChecksBothBytesOfTheCrc) {
  for (const auto* end : {"< 582#D572130000000000", "< 582#D573120000000000"}) {
    upload({{"> 602#A40020017F000000", "< 582#C600200102000000", "> 602#A300000000000000"},
            {"< 582#8101020000000000", "> 602#A2017F0000000000"},
            {end, "> 602#8000200104000405"}});
    EXPECT_EQ(outcome(), "the checksum of the block transfer is wrong");
  }
  upload({{"> 602#A40020017F000000", "< 582#C600200102000000", "> 602#A300000000000000"},
          {"< 582#8101020000000000", "> 602#A2017F0000000000"},
          {"< 582#D573130000000000", "> 602#A100000000000000"}});
  EXPECT_EQ(outcome(), "2");
}

TEST_F(ClientBlockTest, RefusesCommandsOutOfPlaceInARead) {
  upload({{"> 602#A40020017F000000"},
          {"< 582#C200200202000000"},
          {"< 582#C300200102000000", "> 602#8000200101000405"}});
  EXPECT_EQ(outcome(), "it answered the block transfer request with command 0xC3");
  upload({{"> 602#A40020017F000000", "< 582#C200200102000000", "> 602#A300000000000000"},
          {"< 582#8101020000000000", "> 602#A2017F0000000000"},
          {"< 582#C000000000000000", "> 602#8000200101000405"}});
  EXPECT_EQ(outcome(), "it ended a block transfer with command 0xC0");
}

TEST_F(ClientBlockTest, RefusesCommandsOutOfPlaceInAWrite) {
  const Lines start = {"> 602#C600200109000000", "< 582#A00020017F000000", "> 602#0101020304050607",
                       "> 602#8208090000000000"};
  download(9, {{"> 602#C600200109000000"},
               {"< 582#A00020027F000000"},
               {"< 582#A10020017F000000", "> 602#8000200101000405"}});
  EXPECT_EQ(outcome(), "it answered the block transfer request with command 0xA1");
  download(9, {{"> 602#C600200109000000", "< 582#A000200180000000", "> 602#8000200102000405"}});
  EXPECT_EQ(outcome(), "it asks for blocks of 128 segments");
  download(9, {start, {"< 582#A00020017F000000"}, {"< 582#A00020027F000000", "> 602#8000200101000405"}});
  EXPECT_EQ(outcome(), "it answered a block with command 0xA0");
  download(9, {start, {"< 582#A2027F0000000000", "> 602#D500000000000000"}});
  EXPECT_EQ(client.deadline(), now + 500ms);
  steps({{"< 582#A2027F0000000000"}, {"< 582#A300000000000000", "> 602#8000200101000405"}});
  EXPECT_EQ(outcome(), "it answered the end of a block transfer with command 0xA3");
}

TEST_F(ClientBlockTest, TakesARepeatedAcknowledgeOnceMoreAndANewOneNot) {
  const Lines start = {"> 602#C600200109000000", "< 582#A000200101000000", "> 602#0101020304050607"};
  download(9, {start,
               {"< 582#A201010000000000", "> 602#8108090000000000"},
               {"< 582#A201010000000000", "> 602#D500000000000000"}});
  steps({{"< 582#A100000000000000"}});
  EXPECT_EQ(outcome(), "0");
  client.start_download({0x2000, 1}, Bytes(20, 1), now, Transfer::block);
  steps({{"> 602#C600200114000000", "< 582#A000200102000000", "> 602#0101010101010101",
          "> 602#0201010101010101"}});
  client.on_frame(frame("582#A202020000000000"), now);
  EXPECT_EQ(client.deadline(), kNever);
  client.on_frame(frame("582#A202020000000000"), now);
  EXPECT_TRUE(client.busy());
  steps({{"> 602#8101010101010100"}});
  client.on_frame(frame("582#A202030000000000"), now);
  steps({{"> 602#8000200103000405"}});
  EXPECT_EQ(outcome(), "it acknowledged segment 2 and asked for blocks of 3");
}

TEST_F(ClientBlockTest, TakesAnAcknowledgeThatLooksLikeItsObject) {
  const Lines start = {"> 602#C600200109000000", "< 582#A00020017F000000", "> 602#0101020304050607",
                       "> 602#8208090000000000"};
  download(9, {start, {"< 582#A200200100000000", "> 602#0101020304050607", "> 602#8208090000000000"}});
}

TEST_F(ClientBlockTest, ForgetsTheAcknowledgeOfTheTransferBefore) {
  const Lines start = {"> 602#C600200109000000", "< 582#A00020017F000000", "> 602#0101020304050607",
                       "> 602#8208090000000000"};
  download(9, {start, {"< 582#A2027F0000000000", "> 602#D500000000000000", "< 582#A100000000000000"}});
  EXPECT_EQ(outcome(), "0");
  download(9, {{"> 602#C600200109000000", "< 582#A000200101000000", "> 602#0101020304050607"},
               {"< 582#A2027F0000000000", "> 602#8000200103000405"}});
  EXPECT_EQ(outcome(), "it acknowledged segment 2 and asked for blocks of 127");
}

}  // namespace
}  // namespace servoctl::canopen
