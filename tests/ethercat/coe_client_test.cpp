#include "ethercat/coe_client.hpp"

#include "ethercat/coe_abort.hpp"
#include "messages.hpp"

namespace servoctl::ethercat {
namespace {

using namespace std::chrono_literals;
using canopen::Transfer;

class CoeClientTest : public testing::Test {
 protected:
  void upload(ObjectAddress object, std::initializer_list<std::string_view> lines) {
    client.start_upload(object, now);
    play(client, now, lines);
  }
  void download(ObjectAddress object, Bytes data, std::initializer_list<std::string_view> lines,
                Transfer transfer = Transfer::automatic, bool complete = false) {
    client.start_download(object, std::move(data), now, transfer, complete);
    play(client, now, lines);
  }
  Result<Bytes> result() {
    auto first = client.take_result();
    EXPECT_TRUE(first) << "the transfer has not ended";
    EXPECT_FALSE(client.take_result()) << "two results";
    EXPECT_FALSE(client.busy());
    EXPECT_EQ(client.deadline(), kNever);
    return first ? *first : Result<Bytes>(fail(Errc::bug, "none"));
  }
  std::string data() {
    const auto r = result();
    return r ? to_hex(*r) : r.error().message;
  }
  void expect_failure(Errc code, std::string_view message, std::optional<std::uint32_t> abort = {}) {
    const auto r = result();
    ASSERT_FALSE(r);
    EXPECT_EQ(r.error().code, code);
    EXPECT_EQ(r.error().message, message);
    EXPECT_EQ(r.error().abort_code, abort);
    EXPECT_EQ(r.error().node, 2);
    EXPECT_TRUE(r.error().object);
  }

  CoeClient client{2, 500ms, 26};  // A mailbox of 32 bytes.
  TimePoint now{1s};
};

Bytes counted(std::size_t size) {
  Bytes out(size);
  for (std::size_t i = 0; i < size; ++i) out[i] = static_cast<std::uint8_t>(i + 1);
  return out;
}

// Messages of real slaves, from the captures of ethercrab (MIT or Apache-2.0): EK1914 in
// tests/replay-ek1914-el3004-*.pcapng, an AKD drive and a LAN9252 board in dumps/soem-sdinfo-akd.pcapng and
// dumps/soem-single-lan9252.pcapng.

TEST_F(CoeClientTest, ReadsExpeditedAsARealSlaveAnswers) {
  upload({0x100A, 0}, {"> 0020400A100000000000", "< 00304B0A100030380000"});
  EXPECT_EQ(data(), "30 38");
  upload({0xF008, 0}, {"> 00204008F00000000000", "< 00304308F00001000000"});
  EXPECT_EQ(data(), "01 00 00 00");
  upload({0x1C00, 0}, {"> 002040001C0000000000", "< 00304F001C0004000000"});
  EXPECT_EQ(data(), "04");
}

TEST_F(CoeClientTest, WritesExpeditedAsARealSlaveTakesIt) {
  download({0x1C12, 0}, {0}, {"> 00202F121C0000000000", "< 003060121C0000000000"});
  EXPECT_EQ(data(), "");
  download({0x1C13, 1}, {0x00, 0x1A}, {"> 00202B131C01001A0000", "< 003060131C01001A0000"});
  EXPECT_EQ(data(), "");
  download({0xF008, 0}, {1, 0, 0, 0}, {"> 00202308F00001000000", "< 00306008F00001000000"});
  EXPECT_EQ(data(), "");
  download({0x2000, 1}, {1, 2, 3}, {"> 002027002001010203 00", "< 003060002001 00000000"});
  EXPECT_EQ(data(), "");
}

TEST_F(CoeClientTest, ReadsANormalAnswerOfARealSlave) {
  upload({0x1008, 0}, {"> 00204008100000000000", "< 00304108100006000000454B31393134"});
  EXPECT_EQ(data(), "45 4B 31 39 31 34");
}

TEST_F(CoeClientTest, ReadsAllEntriesAtOnceAsARealSlaveGivesThem) {
  client.start_upload({0x1C00, 0}, now, Transfer::automatic, true);
  play(client, now, {"> 002050001C0000000000", "< 003051001C0006000000040001020304"});
  EXPECT_EQ(data(), "04 00 01 02 03 04");
  client.start_upload({0x1C12, 0}, now, Transfer::automatic, true);
  play(client, now, {"> 002050121C0000000000", "< 003053121C0001000116"});
  EXPECT_EQ(data(), "01 00 01 16");
}

TEST_F(CoeClientTest, TakesFourBytesWhenTheSizeIsNotIndicated) {
  upload({0x1018, 1}, {"> 00204018100100000000", "< 00304218100101020304"});
  EXPECT_EQ(data(), "01 02 03 04");
}

TEST_F(CoeClientTest, LeavesWhatIsBehindTheDataOfAnAnswer) {
  upload({0x1018, 1}, {"> 00204018100100000000", "< 00304F18100101000000CCCCCCCC"});
  EXPECT_EQ(data(), "01");
  upload({0x1008, 0}, {"> 00204008100000000000", "< 00304108100003000000414243CCCC"});
  EXPECT_EQ(data(), "41 42 43");
}

TEST_F(CoeClientTest, ReadsInSegmentsLongerThanOnCan) {
  upload({0x1008, 0},
         {"> 00204008100000000000", "< 00304108100014000000 0102030405060708", "> 00206000000000000000",
          "< 003000 090A0B0C0D0E0F10", "> 00207000000000000000", "< 003017 11121314000000"});
  EXPECT_EQ(data(), to_hex(counted(20)));
}

TEST_F(CoeClientTest, OnlyALastSegmentOfSevenBytesSaysHowManyAreUnused) {
  // Bits 1 to 3 set in a segment of eight: they say nothing.
  upload({0x1008, 0}, {"> 00204008100000000000", "< 00304108100008000000", "> 00206000000000000000",
                       "< 00300F 0102030405060708"});
  EXPECT_EQ(data(), to_hex(counted(8)));
  upload({0x1008, 0}, {"> 00204008100000000000", "< 00304108100002000000", "> 00206000000000000000",
                       "< 00300B 01020000000000"});
  EXPECT_EQ(data(), "01 02");
  // One that fills up to seven without saying so.
  upload({0x1008, 0}, {"> 00204008100000000000", "< 00304108100002000000", "> 00206000000000000000",
                       "< 003001 01020000000000"});
  EXPECT_EQ(data(), "01 02");
}

TEST_F(CoeClientTest, ReadsAnEmptyObject) {
  upload({0x1008, 0}, {"> 00204008100000000000", "< 00304108100000000000"});
  EXPECT_EQ(data(), "");
}

TEST_F(CoeClientTest, WritesInOneMessageWhatFits) {
  download({0x2000, 0}, counted(5), {"> 00202100200005000000 0102030405", "< 00306000200000000000"});
  EXPECT_EQ(data(), "");
  download({0x2000, 0}, {}, {"> 00202100200000000000", "< 00306000200000000000"});
  EXPECT_EQ(data(), "");
  download({0x2000, 0}, counted(16),
           {"> 00202100200010000000 0102030405060708090A0B0C0D0E0F10", "< 00306000200000000000"});
  EXPECT_EQ(data(), "");
}

TEST_F(CoeClientTest, WritesTheRestInSegments) {
  // 16 bytes in the first message, 23 in a segment, the rest padded to seven.
  download({0x2000, 0}, counted(41),
           {"> 00202100200029000000 0102030405060708090A0B0C0D0E0F10", "< 00306000200000000000",
            "> 002000 1112131415161718191A1B1C1D1E1F2021222324252627", "< 003020 00000000000000",
            "> 00201B 28290000000000", "< 003030 00000000000000"});
  EXPECT_EQ(data(), "");
  download({0x2000, 0}, counted(24),
           {"> 00202100200018000000 0102030405060708090A0B0C0D0E0F10", "< 00306000200000000000",
            "> 002001 1112131415161718", "< 003020 00000000000000"});
  EXPECT_EQ(data(), "");
}

TEST_F(CoeClientTest, WritesAllEntriesAtOnceWhereAskedTo) {
  download({0x1C12, 0}, {1, 0, 0x01, 0x16}, {"> 002031121C0004000000 01000116", "< 003070121C0000000000"},
           Transfer::automatic, true);
  EXPECT_EQ(data(), "");
}

TEST_F(CoeClientTest, AKindOfTransferThatWasNamedIsTheOne) {
  download({0x6060, 0}, {3}, {"> 00202160600001000000 03", "< 00306060600000000000"}, Transfer::segmented);
  EXPECT_EQ(data(), "");
  client.start_upload({0x1008, 0}, now, Transfer::expedited);
  play(client, now,
       {"> 00204008100000000000", "< 00304108100006000000454B31393134", "> 00208008100000000106"});
  expect_failure(Errc::protocol,
                 "node 2, object 0x1008:0: it does not answer this read in one expedited message");
  download({0x2000, 0}, counted(5), {}, Transfer::expedited);
  expect_failure(Errc::usage, "node 2, object 0x2000:0: 5 bytes do not fit into one expedited message");
  download({0x2000, 0}, counted(5), {}, Transfer::block);
  expect_failure(Errc::usage, "node 2, object 0x2000:0: there are no block transfers over EtherCAT");
}

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
      r.error().message,
      "node 2, object 0x6040:0: refused: object is mapped to an RxPDO, download blocked (abort 0x06010006)");
  EXPECT_NE(r.error().hint, "");
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
  expect_failure(
      Errc::timeout,
      "node 2, object 0x6060:0: no answer within 500 ms, only one to another request (command 0x60)");
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

TEST_F(CoeClientTest, SaysHowFarItIs) {
  client.start_download({0x2000, 0}, counted(41), now);
  EXPECT_EQ(client.total(), 41U);
  EXPECT_EQ(client.transferred(), 16U);
  (void)client.take_message();
  client.on_message(hex("00306000200000000000"), now);
  EXPECT_EQ(client.transferred(), 39U);
  client.on_message(hex("00308000200000000008"), now);
  (void)client.take_result();
  client.start_upload({0x1008, 0}, now);
  EXPECT_EQ(client.total(), std::nullopt);
  client.on_message(hex("00304108100014000000 0102030405060708"), now);
  EXPECT_EQ(client.transferred(), 8U);
  EXPECT_EQ(client.total(), 20U);
}

}  // namespace
}  // namespace servoctl::ethercat
