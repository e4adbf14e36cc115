#include "canopen/sdo_client.hpp"

#include "one_object.hpp"
#include "transcript.hpp"

namespace servoctl::canopen {
namespace {

using namespace std::chrono_literals;

class SdoClientTest : public testing::Test {
 protected:
  void upload(ObjectAddress object, std::initializer_list<std::string_view> lines) {
    client.start_upload(object, now);
    play(client, now, lines);
  }
  void download(ObjectAddress object, Bytes data, std::initializer_list<std::string_view> lines) {
    client.start_download(object, std::move(data), now);
    play(client, now, lines);
  }
  /// The one result; a second one would be a failure.
  Result<Bytes> result() {
    auto first = client.take_result();
    EXPECT_TRUE(first) << "the transfer has not ended";
    EXPECT_FALSE(client.take_result()) << "two results";
    return first ? *first : Result<Bytes>(fail(Errc::bug, "none"));
  }
  void expect_failure(Errc code, std::string_view message, std::optional<std::uint32_t> abort = {}) {
    const auto r = result();
    ASSERT_FALSE(r);
    EXPECT_EQ(r.error().code, code);
    EXPECT_EQ(r.error().message.text(), message);
    EXPECT_EQ(r.error().abort_code, abort);
    EXPECT_EQ(r.error().node, 2);
    EXPECT_FALSE(client.busy());
    EXPECT_EQ(client.deadline(), kNever);
  }

  SdoClient client{2, 500ms};
  TimePoint now{1s};
};

TEST_F(SdoClientTest, ReadsOneToFourBytesExpedited) {
  upload({0x6041, 0}, {"> 602#4041600000000000", "< 582#4F41600050000000"});
  EXPECT_EQ(result().value(), Bytes{0x50});
  upload({0x6041, 0}, {"> 602#4041600000000000", "< 582#4B41600050020000"});
  EXPECT_EQ(result().value(), (Bytes{0x50, 0x02}));
  upload({0x6041, 0}, {"> 602#4041600000000000", "< 582#4741600050020300"});
  EXPECT_EQ(result().value(), (Bytes{0x50, 0x02, 0x03}));
  upload({0x6041, 0}, {"> 602#4041600000000000", "< 582#4341600050020304"});
  EXPECT_EQ(result().value(), (Bytes{0x50, 0x02, 0x03, 0x04}));
}

TEST_F(SdoClientTest, TakesFourBytesWhenTheSizeIsNotIndicated) {
  upload({0x1018, 1}, {"> 602#4018100100000000", "< 582#4218100101020304"});
  EXPECT_EQ(result().value(), (Bytes{1, 2, 3, 4}));
}

TEST_F(SdoClientTest, WritesOneToFourBytesExpedited) {
  download({0x6060, 0}, {3}, {"> 602#2F60600003000000", "< 582#6060600000000000"});
  EXPECT_TRUE(result());
  download({0x6040, 0}, {0x0F, 0}, {"> 602#2B4060000F000000", "< 582#6040600000000000"});
  EXPECT_TRUE(result());
  download({0x2000, 1}, {1, 2, 3}, {"> 602#2700200101020300", "< 582#6000200100000000"});
  EXPECT_TRUE(result());
  download({0x60FF, 0}, {0xE8, 3, 0, 0}, {"> 602#23FF6000E8030000", "< 582#60FF600000000000"});
  EXPECT_TRUE(result());
}

TEST_F(SdoClientTest, AcceptsAnAcknowledgeThatEchoesTheData) {
  download({0x6060, 0}, {3}, {"> 602#2F60600003000000", "< 582#6060600003000000"});
  EXPECT_TRUE(result());
}

TEST_F(SdoClientTest, ReadsALongObjectInSegments) {
  upload({0x1008, 0}, {"> 602#4008100000000000", "< 582#410810001A000000", "> 602#6000000000000000",
                       "< 582#0054696E79204E6F", "> 602#7000000000000000", "< 582#106465202D204D65",
                       "> 602#6000000000000000", "< 582#0067612D446F6D61", "> 602#7000000000000000",
                       "< 582#15696E7320210000"});
  const auto bytes = result().value();
  EXPECT_EQ(std::string(bytes.begin(), bytes.end()), "Tiny Node - Mega-Domains !");
}

TEST_F(SdoClientTest, ReadsSegmentsOfAnObjectWhoseSizeIsNotAnnounced) {
  upload({0x1008, 0}, {"> 602#4008100000000000", "< 582#4008100000000000", "> 602#6000000000000000",
                       "< 582#0D41000000000000"});
  EXPECT_EQ(result().value(), Bytes{0x41});
}

TEST_F(SdoClientTest, ReadsAnEmptyObject) {
  upload({0x1008, 0}, {"> 602#4008100000000000", "< 582#4108100000000000", "> 602#6000000000000000",
                       "< 582#0F00000000000000"});
  EXPECT_EQ(result().value(), Bytes{});
}

TEST_F(SdoClientTest, WritesInSegmentsAtEveryEdgeOfTheSegmentSize) {
  download({0x2000, 0}, {},
           {"> 602#2100200000000000", "< 582#6000200000000000", "> 602#0F00000000000000",
            "< 582#2000000000000000"});
  EXPECT_TRUE(result());
  download({0x2000, 0}, counted(5),
           {"> 602#2100200005000000", "< 582#6000200000000000", "> 602#0501020304050000",
            "< 582#2000000000000000"});
  EXPECT_TRUE(result());
  download({0x2000, 0}, counted(7),
           {"> 602#2100200007000000", "< 582#6000200000000000", "> 602#0101020304050607",
            "< 582#2000000000000000"});
  EXPECT_TRUE(result());
  download({0x2000, 0}, counted(8),
           {"> 602#2100200008000000", "< 582#6000200000000000", "> 602#0001020304050607",
            "< 582#2000000000000000", "> 602#1D08000000000000", "< 582#3000000000000000"});
  EXPECT_TRUE(result());
  download({0x2000, 0}, counted(15),
           {"> 602#210020000F000000", "< 582#6000200000000000", "> 602#0001020304050607",
            "< 582#2000000000000000", "> 602#1008090A0B0C0D0E", "< 582#3000000000000000",
            "> 602#0D0F000000000000", "< 582#2000000000000000"});
  EXPECT_TRUE(result());
}

TEST_F(SdoClientTest, ReportsTheAbortOfTheNode) {
  upload({0x6040, 1}, {"> 602#4040600100000000", "< 582#8040600111000906"});
  expect_failure(Errc::sdo_abort,
                 "node 2, object 0x6040:1: refused: sub-index does not exist (abort 0x06090011)",
                 0x0609'0011);
}

TEST_F(SdoClientTest, ARefusedWriteOfAMappingNamesTheStepsARefusedReadDoesNot) {
  download({0x1600, 1}, {0x10, 0x00, 0x40, 0x60}, {"> 602#2300160110004060", "< 582#8000160100000106"});
  EXPECT_NE(result().error().hint.text().find("`pdo map`"), std::string::npos);
  upload({0x1600, 1}, {"> 602#4000160100000000", "< 582#8000160100000106"});
  EXPECT_EQ(result().error().hint.text(), "");
}

TEST_F(SdoClientTest, ReportsAnAbortInTheMiddleOfASegmentedTransfer) {
  download({0x2000, 0}, counted(20),
           {"> 602#2100200014000000", "< 582#6000200000000000", "> 602#0001020304050607",
            "< 582#8000200000000008"});
  expect_failure(Errc::sdo_abort, "node 2, object 0x2000:0: refused: general error (abort 0x08000000)",
                 0x0800'0000);
}

TEST_F(SdoClientTest, IgnoresWhatIsNotTheAnswerToItsRequest) {
  client.start_upload({0x1018, 1}, now);
  (void)client.take_frame();
  auto remote = frame("582#R");
  auto extended = frame("00000582#4318100109000000");
  for (const auto& noise : {remote, extended, frame("583#4318100109000000"), frame("582#4341600009000000"),
                            frame("582#8041600000000206"), frame("582#6041600000000000"), frame("702#05"),
                            frame("082#00FF010000000000")})
    client.on_frame(noise, now);
  EXPECT_FALSE(client.take_result());
  EXPECT_FALSE(client.take_frame());
  client.on_frame(frame("582#4318100104000000"), now);
  EXPECT_EQ(result().value(), (Bytes{4, 0, 0, 0}));
}

TEST_F(SdoClientTest, IgnoresAFirstAnswerThatComesTwice) {
  upload({0x1008, 0}, {"> 602#4008100000000000", "< 582#4108100001000000", "> 602#6000000000000000",
                       "< 582#4108100001000000", "< 582#0D41000000000000"});
  EXPECT_EQ(result().value(), Bytes{0x41});
  download({0x2000, 0}, counted(5),
           {"> 602#2100200005000000", "< 582#6000200000000000", "> 602#0501020304050000",
            "< 582#6000200000000000", "< 582#2000000000000000"});
  EXPECT_TRUE(result());
}

TEST_F(SdoClientTest, IgnoresAnswersAfterTheTransferHasEnded) {
  upload({0x6041, 0}, {"> 602#4041600000000000", "< 582#4B41600050020000", "< 582#4B41600050020000",
                       "< 582#8041600000000206"});
  EXPECT_EQ(result().value(), (Bytes{0x50, 0x02}));
}

TEST_F(SdoClientTest, AbortsWhenTheToggleBitDoesNotAlternate) {
  upload({0x1008, 0}, {"> 602#4008100000000000", "< 582#410810001A000000", "> 602#6000000000000000",
                       "< 582#1054696E79204E6F", "> 602#8008100000000305"});
  expect_failure(Errc::protocol, "node 2, object 0x1008:0: the toggle bit of its segment did not alternate");
  download({0x2000, 0}, counted(8),
           {"> 602#2100200008000000", "< 582#6000200000000000", "> 602#0001020304050607",
            "< 582#3000000000000000", "> 602#8000200000000305"});
  expect_failure(Errc::protocol, "node 2, object 0x2000:0: the toggle bit of its answer did not alternate");
}

TEST_F(SdoClientTest, AbortsOnACommandThatIsNoAnswer) {
  upload({0x1018, 1}, {"> 602#4018100100000000", "< 582#2018100100000000", "> 602#8018100101000405"});
  expect_failure(Errc::protocol, "node 2, object 0x1018:1: it answered a read with command 0x20");
  download({0x1018, 1}, {1}, {"> 602#2F18100101000000", "< 582#2018100100000000", "> 602#8018100101000405"});
  expect_failure(Errc::protocol, "node 2, object 0x1018:1: it answered a write with command 0x20");
  upload({0x1018, 1}, {"> 602#4018100100000000", "< 582#4118100108000000", "> 602#6000000000000000",
                       "< 582#2000000000000000", "> 602#8018100101000405"});
  expect_failure(Errc::protocol, "node 2, object 0x1018:1: it answered a segment request with command 0x20");
}

TEST_F(SdoClientTest, AbortsWhenTheSizeIsNotTheOneAnnounced) {
  upload({0x1008, 0}, {"> 602#4008100000000000", "< 582#4108100002000000", "> 602#6000000000000000",
                       "< 582#0941424300000000", "> 602#8008100010000706"});
  expect_failure(Errc::protocol, "node 2, object 0x1008:0: it announced 2 bytes and sent 3");
  upload({0x1008, 0}, {"> 602#4008100000000000", "< 582#41081000FFFFFFFF", "> 602#8008100005000405"});
  expect_failure(Errc::protocol, "node 2, object 0x1008:0: it announces 4294967295 bytes for this object");
}

TEST_F(SdoClientTest, RefusesAnAnswerThatIsNotEightBytesLong) {
  upload({0x1018, 1}, {"> 602#4018100100000000", "< 582#4F181001", "> 602#8018100101000405"});
  expect_failure(Errc::protocol, "node 2, object 0x1018:1: its answer has 4 bytes instead of 8");
}

TEST_F(SdoClientTest, TellsTheNodeOnceThatTheTransferTimedOut) {
  client.start_upload({0x1018, 1}, now);
  (void)client.take_frame();
  EXPECT_EQ(client.deadline(), now + 500ms);
  client.on_time(now + 499ms);
  EXPECT_FALSE(client.take_result());
  play(client, now, {"+ 500ms", "> 602#8018100100000405", "+ 500ms"});
  expect_failure(Errc::timeout, "node 2, object 0x1018:1: no answer within 500 ms");
}

TEST_F(SdoClientTest, WaitsAnewAfterEverySegment) {
  upload({0x1008, 0},
         {"> 602#4008100000000000", "+ 400ms", "< 582#4108100008000000", "> 602#6000000000000000", "+ 400ms",
          "< 582#0041424344454647", "> 602#7000000000000000", "+ 400ms", "< 582#1D48000000000000"});
  EXPECT_EQ(result().value().size(), 8U);
}

}  // namespace
}  // namespace servoctl::canopen
