// Bytes are from the descriptions of the formats: draft-ietf-opsawg-pcap, draft-ietf-opsawg-pcapng, and the
// link-layer header types LINKTYPE_CAN_SOCKETCAN, LINKTYPE_LINUX_SLL and LINKTYPE_LINUX_SLL2 of the tcpdump
// group.
#include "can/pcap.hpp"

#include <gtest/gtest.h>

#include "tests/can/recording_bytes.hpp"

namespace servoctl::can {
namespace {

using Packets = std::vector<std::string>;

/// Identifier big-endian, length, flags of CAN FD, two unused, data.
const std::string kSdo = FileBytes().bytes({0, 0, 6, 1, 8, 0, 0, 0, 0x40, 0x41, 0x60, 0, 0, 0, 0, 0}).str();

FileBytes pcap_head(std::uint32_t magic, bool big_endian, std::uint32_t link) {
  FileBytes out(big_endian);
  out.u32(magic).u16(2).u16(4).u32(0).u32(0).u32(262'144).u32(link);
  return out;
}

FileBytes& add_packet(FileBytes& file, std::uint32_t second, std::uint32_t fraction, std::string_view bytes) {
  return file.u32(second).u32(fraction).u32(bytes.size()).u32(bytes.size()).text(bytes);
}

TEST(Pcap, ReadsCanFramesInAnyByteOrderAndResolution) {
  for (const bool big : {false, true}) {
    auto micros = pcap_head(0xA1B2C3D4, big, 227);
    EXPECT_EQ(frames_of(add_packet(micros, 1'700'000'000, 123'456, kSdo).str()),
              (Packets{"(1700000000.123456) can0 601#4041600000000000"}));
    auto nanos = pcap_head(0xA1B23C4D, big, 227);
    EXPECT_EQ(frames_of(add_packet(nanos, 1'700'000'000, 123'456'789, kSdo).str()),
              (Packets{"(1700000000.123456) can0 601#4041600000000000"}));
  }
}

TEST(Pcap, KnowsTheFlagsOfAnIdentifier) {
  auto file = pcap_head(0xA1B2C3D4, false, 227);
  add_packet(file, 1, 0, FileBytes().bytes({0x80, 0, 1, 0x23, 1, 0, 0, 0, 0xAA}).str());
  add_packet(file, 2, 0, FileBytes().bytes({0x40, 0, 7, 1, 1, 0, 0, 0}).str());
  add_packet(file, 3, 0, FileBytes().bytes({0x20, 0, 0, 0x40, 8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}).str());
  add_packet(file, 4, 0, FileBytes().bytes({0, 0, 0, 0x80, 0, 0, 0, 0}).str());
  EXPECT_EQ(frames_of(file.str()),
            (Packets{"(0000000001.000000) can0 00000123#AA", "(0000000002.000000) can0 701#R1",
                     "(0000000003.000000) can0 20000040#0000000000000000", "(0000000004.000000) can0 080#"}));
}

TEST(Pcap, CanFdAndOtherNetworksAreUnsuited) {
  auto file = pcap_head(0xA1B2C3D4, false, 227);
  add_packet(file, 1, 0, FileBytes().bytes({0, 0, 6, 1, 1, 4, 0, 0, 0xAA}).str());
  add_packet(file, 2, 0, FileBytes().bytes({0, 0, 6, 1, 12, 4, 0, 0}).zeros(12).str());
  add_packet(file, 3, 0, "abc");
  add_packet(file, 4, 0, FileBytes().bytes({0, 0, 6, 1, 8, 0, 0, 0, 1}).str());
  EXPECT_EQ(frames_of(file.str()), (Packets{"unknown 2 at 3", "unsuited 2"}));
  auto ethernet = pcap_head(0xA1B2C3D4, false, 1);
  EXPECT_EQ(frames_of(add_packet(ethernet, 1, 0, std::string(60, 'x')).str()), (Packets{"unsuited 1"}));
}

TEST(Pcap, ReadsCookedCaptures) {
  // In the byte order of the file, which is little-endian here.
  const auto sdo = FileBytes().bytes({1, 6, 0, 0, 8, 0, 0, 0, 0x40, 0x41, 0x60, 0, 0, 0, 0, 0}).str();
  auto cooked = pcap_head(0xA1B2C3D4, false, 113);
  add_packet(cooked, 1, 0,
             FileBytes().bytes({0, 1, 1, 0x18, 0, 0}).zeros(8).bytes({0, 0x0C}).text(sdo).str());
  add_packet(cooked, 2, 0,
             FileBytes().bytes({0, 0, 0, 1, 0, 6}).zeros(8).bytes({8, 0}).text("an IP packet").str());
  EXPECT_EQ(frames_of(cooked.str()),
            (Packets{"(0000000001.000000) can0 601#4041600000000000", "unsuited 1"}));
  auto cooked2 = pcap_head(0xA1B2C3D4, false, 276);
  add_packet(cooked2, 1, 0,
             FileBytes().bytes({0, 0x0C, 0, 0, 0, 0, 0, 3, 1, 0x18, 1, 0}).zeros(8).text(sdo).str());
  EXPECT_EQ(frames_of(cooked2.str()), (Packets{"(0000000001.000000) can0 601#4041600000000000"}));
}

TEST(Pcap, AFileThatIsCutGivesWhatIsInFrontOfIt) {
  auto file = pcap_head(0xA1B2C3D4, false, 227);
  add_packet(file, 1, 0, kSdo);
  const auto first = file.str().size();
  add_packet(file, 2, 0, kSdo);
  for (auto size = first + 1; size < file.str().size(); ++size) {
    const auto read = frames_of(std::string_view(file.str()).substr(0, size));
    ASSERT_EQ(read.size(), 2U) << size;
    EXPECT_EQ(read[0], "(0000000001.000000) can0 601#4041600000000000");
    EXPECT_TRUE(read[1].starts_with("damage at " + std::to_string(first))) << read[1];
  }
  EXPECT_EQ(frames_of(file.str().substr(0, 10)), (Packets{"damage at 10: its header is cut short"}));
}

TEST(Pcap, AHostileLengthIsToldWithItsPlace) {
  auto file = pcap_head(0xA1B2C3D4, false, 227);
  file.u32(1).u32(0).u32(0xFFFF'FFFF).u32(16).text(kSdo);
  EXPECT_EQ(frames_of(file.str()),
            (Packets{"damage at 24: a packet of 4294967295 bytes begins there, and 16 are left"}));
}

/// One block of pcapng, its length on both sides.
FileBytes& add_block(FileBytes& file, std::uint32_t type, const std::string& body) {
  const auto padded = (body.size() + 3) / 4 * 4;
  return file.u32(type).u32(padded + 12).text(body).zeros(padded - body.size()).u32(padded + 12);
}

FileBytes& add_section(FileBytes& file, bool big) {
  return add_block(file, 0x0A0D0D0A,
                   FileBytes(big).u32(0x1A2B3C4D).u16(1).u16(0).u64(~std::uint64_t{0}).str());
}

std::string enhanced(bool big, std::uint32_t source, std::uint64_t stamp, const std::string& bytes) {
  return FileBytes(big)
      .u32(source)
      .u32(stamp >> 32)
      .u32(stamp & 0xFFFF'FFFF)
      .u32(bytes.size())
      .u32(bytes.size())
      .text(bytes)
      .str();
}

TEST(Pcapng, ReadsInterfacesTheirNamesAndResolutions) {
  for (const bool big : {false, true}) {
    FileBytes file(big);
    add_section(file, big);
    add_block(file, 1,
              FileBytes(big)
                  .u16(227)
                  .u16(0)
                  .u32(0)
                  .u16(2)
                  .u16(5)
                  .text("vcan1")
                  .zeros(3)
                  .u16(9)
                  .u16(1)
                  .bytes({9, 0, 0, 0})
                  .u32(0)
                  .str());
    add_block(file, 1, FileBytes(big).u16(227).u16(0).u32(0).str());
    add_block(file, 1,
              FileBytes(big).u16(227).u16(0).u32(0).u16(9).u16(1).bytes({0x94, 0, 0, 0}).u32(0).str());
    add_block(file, 6, enhanced(big, 0, 1'700'000'000'123'456'789, kSdo));
    add_block(file, 6, enhanced(big, 1, 1'700'000'000'123'456, kSdo));
    add_block(file, 6, enhanced(big, 2, (std::uint64_t{1'700'000'000} << 20U) + (1U << 19U), kSdo));
    EXPECT_EQ(frames_of(file.str()), (Packets{"(1700000000.123456) vcan1 601#4041600000000000",
                                              "(1700000000.123456) can1 601#4041600000000000",
                                              "(1700000000.500000) can2 601#4041600000000000"}));
  }
}

TEST(Pcapng, BlocksOfOtherKindsArePassedOver) {
  FileBytes file;
  add_section(file, false);
  add_block(file, 1, FileBytes().u16(227).u16(0).u32(0).str());
  add_block(file, 5, FileBytes().zeros(24).str());
  add_block(file, 3, FileBytes().u32(16).text(kSdo).str());
  add_block(file, 6, enhanced(false, 7, 0, kSdo));
  EXPECT_EQ(frames_of(file.str()),
            (Packets{"(0000000000.000000) can0 601#4041600000000000", "unknown 1 at 2"}));
}

TEST(Pcapng, ABlockThatIsCutOrTooLongIsToldWithItsPlace) {
  FileBytes file;
  add_section(file, false);
  add_block(file, 1, FileBytes().u16(227).u16(0).u32(0).str());
  add_block(file, 6, enhanced(false, 0, 1'000'000, kSdo));
  const auto begin = file.str().size();
  const auto good = file.str();
  EXPECT_EQ(frames_of(good + "abc").back(),
            "damage at " + std::to_string(begin) + ": it ends in the middle of a block");
  for (const std::uint32_t size : {0U, 8U, 13U, 0xFFFF'FFFCU}) {
    const auto read = frames_of(good + FileBytes().u32(6).u32(size).zeros(8).str());
    ASSERT_EQ(read.size(), 2U) << size;
    EXPECT_TRUE(read[1].starts_with("damage at " + std::to_string(begin))) << read[1];
  }
}

}  // namespace
}  // namespace servoctl::can
