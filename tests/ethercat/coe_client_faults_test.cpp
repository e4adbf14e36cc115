#include "coe_client_fixture.hpp"
#include "ethercat/coe_abort.hpp"

namespace servoctl::ethercat {
namespace {

using namespace std::chrono_literals;

TEST_F(CoeClientTest, AnAbortIsOneInEitherServiceAndWithAnyLowBits) {
  for (const auto* answer : {"< 00308040600111000906", "< 00208040600111000906", "< 00208140600111000906",
                             "< 00209040600111000906"}) {
    client.start_upload({0x6040, 1}, now);
    play(client, now, {"> 00204040600100000000", answer});
    expect_failure(Errc::sdo_abort,
                   "node 2, object 0x6040:1: refused: sub-index does not exist (abort 0x06090011)",
                   0x0609'0011);
  }
}

TEST_F(CoeClientTest, AnAbortThatOnlyEtherCatHasIsToldInWords) {
  download({0x6040, 0}, {6, 0}, {"> 00202B40600006000000", "< 00308040600006000106"});
  const auto r = result();
  ASSERT_FALSE(r);
  EXPECT_EQ(
      r.error().message.text(),
      "node 2, object 0x6040:0: refused: object is mapped to an RxPDO, download blocked (abort 0x06010006)");
  EXPECT_NE(r.error().hint.text(), "");
}

TEST_F(CoeClientTest, HintsSpeakOfStatesOfEtherCat) {
  EXPECT_NE(coe_abort_hint(0x0800'0022, {0x1C12, 0}, true).find("`state preop`"), std::string::npos);
  EXPECT_NE(coe_abort_hint(0x0601'0000, {0x1A00, 1}, true).find("count 0"), std::string::npos);
  EXPECT_EQ(coe_abort_hint(0x0601'0000, {0x1A00, 1}, false), "");
  EXPECT_EQ(coe_abort_hint(0x0604'0042, {0x1A00, 1}, true).find("8 bytes"), std::string::npos);
  EXPECT_EQ(coe_abort_hint(0x0503'0000, {0x1008, 0}, false).find("bus"), std::string::npos);
}

TEST_F(CoeClientTest, ReportsAnAbortInTheMiddle) {
  download({0x2000, 0}, counted(41),
           {"> 00202100200029000000 0102030405060708090A0B0C0D0E0F10", "< 00306000200000000000",
            "> 002000 1112131415161718191A1B1C1D1E1F2021222324252627", "< 00308000200000000008"});
  expect_failure(Errc::sdo_abort, "node 2, object 0x2000:0: refused: general error (abort 0x08000000)",
                 0x0800'0000);
}

TEST_F(CoeClientTest, IgnoresWhatIsNotTheAnswerToItsRequest) {
  client.start_upload({0x1018, 1}, now);
  (void)client.take_message();
  for (const auto* noise :
       {"00304341600009000000", "00308041600000000206", "00306041600000000000", "0010FF811102030405",
        "00804318100109000000", "00204318100109000000", "0030", "00", ""}) {
    client.on_message(hex(noise), now);
    EXPECT_FALSE(client.take_result()) << noise;
    EXPECT_FALSE(client.take_message()) << noise;
  }
  client.on_message(hex("00304318100104000000"), now);
  EXPECT_EQ(data(), "04 00 00 00");
  client.on_message(hex("00304318100104000000"), now);
  EXPECT_FALSE(client.take_result()) << "behind its end";
}

TEST_F(CoeClientTest, IgnoresAFirstAnswerThatComesTwice) {
  upload({0x1008, 0}, {"> 00204008100000000000", "< 00304108100002000000", "> 00206000000000000000",
                       "< 00304108100002000000", "< 00300B 41420000000000"});
  EXPECT_EQ(data(), "41 42");
  download({0x2000, 0}, counted(17),
           {"> 00202100200011000000 0102030405060708090A0B0C0D0E0F10", "< 00306000200000000000",
            "> 00200D 11000000000000", "< 00306000200000000000", "< 003020 00000000000000"});
  EXPECT_EQ(data(), "");
}

TEST_F(CoeClientTest, TheLateAnswerToARequestOfTheOtherKindIsNotThatOfThisOne) {
  upload({0x6060, 0}, {"> 00204060600000000000", "< 00306060600000000000", "< 00304F60600003000000"});
  EXPECT_EQ(data(), "03");
  download({0x6060, 0}, {3}, {"> 00202F60600003000000", "< 00304F60600001000000", "< 00306060600000000000"});
  EXPECT_EQ(data(), "");
  upload({0x6060, 0},
         {"> 00204060600000000000", "< 00306060600000000000", "+ 500ms", "> 00208060600000000405"});
  expect_failure(Errc::protocol,
                 "node 2, object 0x6060:0: no answer within 500 ms; it answered with command 0x60 for object "
                 "0x6060:0");
}

TEST_F(CoeClientTest, AbortsWhenTheToggleBitDoesNotAlternate) {
  upload({0x1008, 0}, {"> 00204008100000000000", "< 0030410810001A000000", "> 00206000000000000000",
                       "< 003010 01020304050607", "> 00208008100000000305"});
  expect_failure(Errc::protocol, "node 2, object 0x1008:0: the toggle bit of its segment did not alternate");
  download({0x2000, 0}, counted(17),
           {"> 00202100200011000000 0102030405060708090A0B0C0D0E0F10", "< 00306000200000000000",
            "> 00200D 11000000000000", "< 003030 00000000000000", "> 00208000200000000305"});
  expect_failure(Errc::protocol, "node 2, object 0x2000:0: the toggle bit of its answer did not alternate");
}

TEST_F(CoeClientTest, AbortsOnAnAnswerThatIsNone) {
  upload({0x1018, 1}, {"> 00204018100100000000", "< 00302018100100000000", "> 00208018100101000405"});
  expect_failure(Errc::protocol, "node 2, object 0x1018:1: it answered a read with command 0x20");
  download({0x1018, 1}, {1}, {"> 00202F18100101000000", "< 0030A018100100000000", "> 00208018100101000405"});
  expect_failure(Errc::protocol, "node 2, object 0x1018:1: it answered a write with command 0xA0");
  upload({0x1018, 1}, {"> 00204018100100000000", "< 0030431810", "> 00208018100101000405"});
  expect_failure(Errc::protocol, "node 2, object 0x1018:1: its answer has 5 bytes instead of 10");
  upload({0x1008, 0}, {"> 00204008100000000000", "< 00304108100008000000", "> 00206000000000000000",
                       "< 003020 00000000000000", "> 00208008100001000405"});
  expect_failure(Errc::protocol, "node 2, object 0x1008:0: it answered a segment request with command 0x20");
}

TEST_F(CoeClientTest, AbortsWhenTheSizeIsNotTheOneAnnounced) {
  upload({0x1008, 0}, {"> 00204008100000000000", "< 00304108100002000000", "> 00206000000000000000",
                       "< 003000 01020304050607", "> 00208008100010000706"});
  expect_failure(Errc::protocol, "node 2, object 0x1008:0: it announced 2 bytes and sent 7 and has more");
  upload({0x1008, 0}, {"> 00204008100000000000", "< 00304108100004000000", "> 00206000000000000000",
                       "< 003009 010203 00000000", "> 00208008100010000706"});
  expect_failure(Errc::protocol, "node 2, object 0x1008:0: it announced 4 bytes and sent 3");
  upload({0x1008, 0}, {"> 00204008100000000000", "< 00304108100002000000", "> 00206000000000000000",
                       "< 003001 0102030405060708", "> 00208008100010000706"});
  expect_failure(Errc::protocol, "node 2, object 0x1008:0: it announced 2 bytes and sent 8");
  upload({0x1008, 0}, {"> 00204008100000000000", "< 003041081000FFFFFFFF", "> 00208008100005000405"});
  expect_failure(Errc::protocol, "node 2, object 0x1008:0: it announces 4294967295 bytes for this object");
}

TEST_F(CoeClientTest, ASegmentWithoutDataEndsATransferThatWouldNeverEnd) {
  upload({0x1008, 0}, {"> 00204008100000000000", "< 00304108100002000000", "> 00206000000000000000",
                       "< 003000", "> 00208008100010000706"});
  expect_failure(Errc::protocol, "node 2, object 0x1008:0: it announced 2 bytes and sent 0 and has more");
}

TEST_F(CoeClientTest, TellsTheNodeOnceThatTheTransferTimedOut) {
  client.start_upload({0x1018, 1}, now);
  (void)client.take_message();
  EXPECT_EQ(client.deadline(), now + 500ms);
  client.on_time(now + 499ms);
  EXPECT_FALSE(client.take_result());
  play(client, now, {"+ 500ms", "> 00208018100100000405", "+ 500ms"});
  expect_failure(Errc::timeout, "node 2, object 0x1018:1: no answer within 500 ms");
}

TEST_F(CoeClientTest, WaitsAnewAfterEverySegment) {
  upload({0x1008, 0},
         {"> 00204008100000000000", "+ 400ms", "< 00304108100008000000", "> 00206000000000000000", "+ 400ms",
          "< 003000 01020304050607", "> 00207000000000000000", "+ 400ms", "< 00301D 08000000000000"});
  EXPECT_EQ(data(), to_hex(counted(8)));
}

TEST_F(CoeClientTest, ARefusalOfTheMailboxAndAFailureEndTheTransfer) {
  client.start_upload({0x1018, 1}, now);
  (void)client.take_message();
  client.on_refusal(7);
  expect_failure(
      Errc::protocol,
      "node 2, object 0x1018:1: its mailbox refuses the request: no memory available (mailbox error 0007h)");
  client.start_upload({0x1018, 1}, now);
  (void)client.take_message();
  client.on_failure(Errc::timeout, "its mailbox stays full", "wait");
  expect_failure(Errc::timeout, "node 2, object 0x1018:1: its mailbox stays full");
  client.on_refusal(7);
  client.on_failure(Errc::timeout, "", "");
  EXPECT_FALSE(client.take_result());
}

}  // namespace
}  // namespace servoctl::ethercat
