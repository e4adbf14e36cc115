// Datagrams on their way through simulated slaves: addresses, working counters, registers, FMMUs (ETG.1000.4,
// clauses 5.4, 6.6 and 6.7).
#include <array>

#include "esc_support.hpp"

namespace servoctl::sim {
namespace {

class EscFrames : public EscTest {
 protected:
  static constexpr std::uint32_t physical(std::uint16_t adp, std::uint16_t ado) {
    return static_cast<std::uint32_t>(ado) << 16U | adp;
  }
};

TEST_F(EscFrames, ABroadcastIsCountedByEverySlaveAndAddsUpWhatTheySay) {
  build(3);
  const auto back =
      send(hex("FFFFFFFFFFFF 101010101010 88A4 0E10 07 01 0000 0000 0200 0000 0000 0000"
               "0000000000000000000000000000 0000000000000000000000000000 00"));
  // The first slave marks the source address; the position counts on; type 11h; three slaves.
  EXPECT_EQ(to_hex(ByteSpan(back).first(30), ""),
            "FFFFFFFFFFFF12101010101088A40E10"
            "0701030000000200000011000300");
}

TEST_F(EscFrames, APositionIsZeroAtTheSlaveThatIsMeant) {
  build(3);
  for (std::uint16_t i = 0; i < 3; ++i) {
    const auto got = datagram(kAprd, physical(static_cast<std::uint16_t>(-i), 0x0010), Bytes(2, 0));
    EXPECT_EQ(got.counter, 1);
    EXPECT_EQ(to_hex(got.data), to_hex(store_le(0x1001U + i, 2)));
    EXPECT_EQ(load_le(ByteSpan(got.header).subspan(2, 2)), static_cast<std::uint16_t>(3 - i));
  }
  EXPECT_EQ(datagram(kAprd, physical(1, 0x0010), Bytes(2, 0)).counter, 0);
}

TEST_F(EscFrames, AStationIsFoundByItsAddressAndByItsAliasWhileThatIsOn) {
  options_ = {};
  load();
  options_.alias = 0x0777;
  build(1);
  EXPECT_EQ(show(0x0012, 2), "77 07");
  EXPECT_EQ(read(0x0010, 2, 0x0777).counter, 0);
  EXPECT_EQ(write(0x0103, "01"), 1);
  EXPECT_EQ(show(0x0010, 2, 0x0777), "01 10");
  EXPECT_EQ(read(0x0010, 2, 0x1002).counter, 0);
}

TEST_F(EscFrames, ReadingAndWritingInOneCountsThree) {
  build(2);
  EXPECT_EQ(write(0x0420, "3412"), 1);
  auto got = datagram(kFprw, physical(kStation, 0x0420), hex("7856"));
  EXPECT_EQ(got.counter, 3);
  EXPECT_EQ(to_hex(got.data), "34 12");
  EXPECT_EQ(show(0x0420, 2), "78 56");
  got = datagram(kAprw, physical(0xFFFF, 0x0420), hex("0100"));
  EXPECT_EQ(got.counter, 3);
  EXPECT_EQ(to_hex(got.data), "E8 03");
  EXPECT_EQ(show(0x0420, 2, 0x1002), "01 00");
  EXPECT_EQ(datagram(kBrw, physical(0, 0x0420), hex("0200")).counter, 6);
  EXPECT_EQ(datagram(kBwr, physical(0, 0x0420), hex("0300")).counter, 2);
}

TEST_F(EscFrames, OneIsReadAndTheOthersAreWritten) {
  build(3);
  EXPECT_EQ(write(0x0420, "2222", 0x1002), 1);
  const auto got = datagram(kFrmw, physical(0x1002, 0x0420), hex("1111"));
  EXPECT_EQ(got.counter, 3);
  EXPECT_EQ(to_hex(got.data), "22 22");
  EXPECT_EQ(show(0x0420, 2, 0x1001), "11 11");
  EXPECT_EQ(show(0x0420, 2, 0x1003), "22 22");
  EXPECT_EQ(datagram(kArmw, physical(0, 0x0420), Bytes(2, 0)).counter, 3);
  EXPECT_EQ(show(0x0420, 2, 0x1003), "11 11");
}

TEST_F(EscFrames, SeveralDatagramsStandInOneFrame) {
  build(1);
  const auto back = send(frame_of({datagram_of(kFpwr, physical(kStation, 0x0420), hex("0A00")),
                                   datagram_of(kFprd, physical(kStation, 0x0420), hex("0000")),
                                   datagram_of(kFprd, physical(0x2222, 0x0420), hex("0000"))}));
  ASSERT_EQ(back.size(), 60U);
  EXPECT_EQ(to_hex(ByteSpan(back).subspan(16 + 12, 2)), "01 00");
  EXPECT_EQ(to_hex(ByteSpan(back).subspan(16 + 14 + 10, 4)), "0A 00 01 00");
  EXPECT_EQ(to_hex(ByteSpan(back).subspan(16 + 28 + 10, 4)), "00 00 00 00");
}

TEST_F(EscFrames, NopAndUnknownCommandsPassUntouched) {
  build(1);
  for (const std::uint8_t command : {std::uint8_t{0}, std::uint8_t{15}, std::uint8_t{0xFF}}) {
    const auto got = datagram(command, physical(0, 0), hex("AABB"));
    EXPECT_EQ(got.counter, 0);
    EXPECT_EQ(to_hex(got.data), "AA BB");
    EXPECT_EQ(to_hex(ByteSpan(got.header).subspan(2, 2)), "00 00");
  }
}

TEST_F(EscFrames, WhatCannotBeWrittenIsNotCounted) {
  build(1);
  for (const auto address : std::to_array<std::uint16_t>({0x0000, 0x0110, 0x0130, 0x0440, 0x0805, 0x0F00}))
    EXPECT_EQ(write(address, "55"), 0) << address;
  EXPECT_EQ(write(0x3000, "55"), 0);
  EXPECT_EQ(read(0x3000, 1).counter, 0);
  EXPECT_EQ(read(0xFFFF, 4).counter, 0);
  EXPECT_EQ(write(0x2FFF, "5566"), 1);
  EXPECT_EQ(show(0x2FFF, 1), "55");
}

TEST_F(EscFrames, BesideAMailboxThereIsPlainMemory) {
  build(1);
  EXPECT_EQ(write(0x1F00, "0102030405060708"), 1);
  EXPECT_EQ(write(0x0808, "021F 0400 22 00 01 00"), 1);  // Nothing lies in it.
  const auto got = datagram(kFprd, physical(kStation, 0x1F00), Bytes(8, 0xEE));
  EXPECT_EQ(got.counter, 1);
  EXPECT_EQ(to_hex(got.data), "01 02 EE EE EE EE 07 08");
  EXPECT_EQ(write(0x1F00, "A1A2A3A4A5A6A7A8"), 1);
  EXPECT_EQ(write(0x080E, "00"), 1);
  EXPECT_EQ(show(0x1F00, 8), "A1 A2 03 04 05 06 A7 A8");
}

TEST_F(EscFrames, AFrameWhoseLengthsDoNotFitGoesNoFurtherAndIsCounted) {
  build(1);
  auto frame = frame_of({datagram_of(kBrd, 0, Bytes(2, 0))});
  frame[16 + 6] = 0x40;  // The datagram says 64 bytes.
  EXPECT_TRUE(send(frame).empty());
  EXPECT_TRUE(send(Bytes(frame.begin(), frame.begin() + 15)).empty());
  EXPECT_EQ(show(0x030C, 1), "02");
  EXPECT_EQ(write(0x030C, "00"), 1);
  EXPECT_EQ(show(0x030C, 1), "00");
}

TEST_F(EscFrames, AForeignFrameComesBackOnlyWhereItMay) {
  build(1);
  auto frame = Bytes(60, 0);
  frame[12] = 0x08;
  EXPECT_TRUE(send(frame).empty());
  EXPECT_EQ(write(0x0100, "00"), 1);
  EXPECT_EQ(send(frame), frame);
}

TEST_F(EscFrames, AnFmmuPutsMemoryIntoALogicalDatagram) {
  build(2);
  // Four bytes at 1F00h of the first at 00010002h, written and read; two of the second behind them, read.
  EXPECT_EQ(write(0x0600, "02000100 0400 00 07 001F 00 03 01 000000"), 1);
  EXPECT_EQ(write(0x0610, "06000100 0200 00 07 001F 00 01 01 000000", 0x1002), 1);
  EXPECT_EQ(write(0x1F00, "A1A2A3A4"), 1);
  EXPECT_EQ(write(0x1F00, "B1B2", 0x1002), 1);
  auto got = datagram(kLrd, 0x0001'0000, Bytes(10, 0xEE));
  EXPECT_EQ(got.counter, 2);
  EXPECT_EQ(to_hex(got.data), "EE EE A1 A2 A3 A4 B1 B2 EE EE");
  got = datagram(kLrw, 0x0001'0000, hex("0001 02030405 0607 0809"));
  EXPECT_EQ(got.counter, 4);  // Both read, the first is written.
  EXPECT_EQ(to_hex(got.data), "00 01 A1 A2 A3 A4 B1 B2 08 09");
  EXPECT_EQ(show(0x1F00, 4), "02 03 04 05");
  EXPECT_EQ(datagram(kLwr, 0x0001'0005, hex("77 88 99")).counter, 1);
  EXPECT_EQ(show(0x1F00, 5), "02 03 04 77 00");
  EXPECT_EQ(datagram(kLrw, 0x0001'0008, Bytes(4, 0)).counter, 0);
  EXPECT_EQ(write(0x060C, "00"), 1);
  EXPECT_EQ(datagram(kLrw, 0x0001'0000, Bytes(6, 0)).counter, 0);
}

TEST_F(EscFrames, AnFmmuMovesSingleBits) {
  build(1);
  // Bits 6, 7 and 0, 1 of the bytes at logical 100h and 101h are bits 3 to 6 at 1F00h.
  EXPECT_EQ(write(0x0600, "00010000 0200 06 01 001F 03 03 01 000000"), 1);
  EXPECT_EQ(write(0x1F00, "B7"), 1);  // 1011 0111: bits 3 to 6 are 0 1 1 0.
  auto got = datagram(kLrd, 0x100, hex("0000"));
  EXPECT_EQ(got.counter, 1);
  EXPECT_EQ(to_hex(got.data), "80 01");
  EXPECT_EQ(datagram(kLwr, 0x100, hex("40FE")).counter, 1);  // Bits 1 0 0 1.
  EXPECT_EQ(show(0x1F00, 1), "CF");
}

TEST_F(EscFrames, DescribesItsController) {
  build(1);
  EXPECT_EQ(show(0x0000, 10), "11 00 02 00 04 08 08 0F 0C 00");
  EXPECT_EQ(show(0x0400, 2), "C2 09");
  EXPECT_EQ(show(0x0420, 2), "E8 03");
}

TEST_F(EscFrames, TheClockOfTheRingIsReadAndLatched) {
  build(1);
  EXPECT_EQ(load_le(read(0x0910, 8).data), 1'000'000'000U);
  EXPECT_EQ(write(0x0920, store_le(5, 8)), 1);
  now_ += std::chrono::microseconds(3);
  EXPECT_EQ(load_le(read(0x0910, 8).data), 1'000'003'005U);
  EXPECT_EQ(datagram(kBwr, physical(0, 0x0900), Bytes(4, 0)).counter, 1);
  EXPECT_EQ(load_le(read(0x0918, 8).data), 1'000'003'000U);
  EXPECT_EQ(load_le(read(0x0900, 4).data), 1'000'003'000U);
}

}  // namespace
}  // namespace servoctl::sim
