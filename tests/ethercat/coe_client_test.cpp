#include "coe_client_fixture.hpp"

namespace servoctl::ethercat {
namespace {

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
