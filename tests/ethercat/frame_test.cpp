#include "ethercat/frame.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "ethercat/registers.hpp"
#include "hex.hpp"

namespace servoctl::ethercat {
namespace {

constexpr MacAddress kSource{0x10, 0x10, 0x10, 0x10, 0x10, 0x10};

std::vector<Datagram> datagrams(ByteSpan frame) {
  std::vector<Datagram> out;
  auto reader = FrameReader::open(frame);
  EXPECT_TRUE(reader) << (reader ? "" : reader.error().message.text());
  if (!reader) return out;
  while (const auto datagram = reader->next()) out.push_back(*datagram);
  return out;
}

std::string refusal(ByteSpan frame) {
  const auto reader = FrameReader::open(frame);
  return reader ? "accepted" : reader.error().message.text();
}

TEST(Frame, OneDatagramIsWrittenAsAPublicMasterWritesIt) {
  // First frame of tests/replay-ek1914-el3004-configure.pcapng of ethercrab (MIT or Apache-2.0), padded as on
  // the wire.
  std::array<std::uint8_t, kMaxFrame> buffer;
  buffer.fill(0xEE);
  FrameWriter writer(buffer, kSource);
  EXPECT_TRUE(writer.add(Command::brd, 0, physical_address(0, reg::kType), Bytes{0}));
  EXPECT_EQ(
      to_hex(writer.finish()),
      "FF FF FF FF FF FF 10 10 10 10 10 10 88 A4 0D 10 07 00 00 00 00 00 01 00 00 00 00 00 00" + [] {
        std::string pad;
        for (int i = 0; i < 31; ++i) pad += " 00";
        return pad;
      }());
}

TEST(Frame, SeveralDatagramsAreReadAsAnotherMastersSlavesAnsweredThem) {
  // Frame 515 of dumps/twincat-scan-boxes.pcapng of ethercrab: two slaves answer a read of their SII.
  const auto frame = hex(
      "01010501000002000000000088a4341001ff020002050e80040040000800000002000000522c4c04010001ff010002050e000400500008000000020000005230ec030100");
  const auto read = datagrams(frame);
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].command, Command::aprd);
  EXPECT_EQ(read[0].index, 0xFF);
  EXPECT_EQ(read[0].adp(), 2);
  EXPECT_EQ(read[0].ado(), reg::kSiiControl);
  EXPECT_EQ(read[0].interrupts, 4);
  EXPECT_EQ(to_hex(read[0].data), "40 00 08 00 00 00 02 00 00 00 52 2C 4C 04");
  EXPECT_EQ(read[0].working_counter, 1);
  EXPECT_EQ(read[0].offset, kFrameHeader);
  EXPECT_FALSE(read[0].circulating);
  EXPECT_EQ(read[1].adp(), 1);
  EXPECT_EQ(to_hex(read[1].data), "50 00 08 00 00 00 02 00 00 00 52 30 EC 03");
  EXPECT_EQ(read[1].working_counter, 1);
}

TEST(Frame, AnAnswerIsMadeInPlace) {
  std::array<std::uint8_t, kMaxFrame> buffer{};
  FrameWriter writer(buffer, kSource);
  ASSERT_TRUE(writer.add(Command::fprd, 7, physical_address(0x1001, reg::kAlStatus), Bytes(6)));
  ASSERT_TRUE(writer.add(Command::lrw, 8, 0x0001'0000, Bytes{1, 2, 3}));
  const auto size = writer.finish().size();
  const std::span<std::uint8_t> frame(buffer.data(), size);
  const auto asked = datagrams(frame);
  ASSERT_EQ(asked.size(), 2U);
  data_of(frame, asked[0])[0] = 0x12;
  set_working_counter(frame, asked[0], 1);
  set_interrupts(frame, asked[0], 0x0102);
  set_address(frame, asked[1], 0x0001'0005);
  set_working_counter(frame, asked[1], 0x0203);
  const auto answered = datagrams(frame);
  EXPECT_EQ(to_hex(answered[0].data), "12 00 00 00 00 00");
  EXPECT_EQ(answered[0].working_counter, 1);
  EXPECT_EQ(answered[0].interrupts, 0x0102);
  EXPECT_EQ(answered[0].address, asked[0].address);
  EXPECT_EQ(answered[1].address, 0x0001'0005U);
  EXPECT_EQ(to_hex(answered[1].data), "01 02 03");
  EXPECT_EQ(answered[1].working_counter, 0x0203);
}

TEST(Frame, ALongFrameIsNotPaddedAndAFullOneTakesNoMore) {
  std::array<std::uint8_t, kMaxFrame + 100> buffer{};
  FrameWriter writer(buffer, kSource);
  EXPECT_TRUE(writer.empty());
  EXPECT_EQ(writer.room(), kMaxDatagramData);
  EXPECT_FALSE(writer.add(Command::fpwr, 0, 0, Bytes(kMaxDatagramData + 1)));
  EXPECT_TRUE(writer.add(Command::fpwr, 0, 0, Bytes(kMaxDatagramData - kDatagramOverhead)));
  EXPECT_EQ(writer.room(), 0U);
  EXPECT_TRUE(writer.add(Command::nop, 1, 0, {}));
  EXPECT_EQ(writer.room(), std::nullopt);
  EXPECT_FALSE(writer.add(Command::nop, 2, 0, {}));
  const auto frame = writer.finish();
  EXPECT_EQ(frame.size(), kMaxFrame);
  EXPECT_EQ(datagrams(frame).size(), 2U);
}

TEST(Frame, WhatIsNoEtherCatIsSomebodyElses) {
  Bytes arp(60);
  arp[12] = 0x08;
  arp[13] = 0x06;
  EXPECT_FALSE(is_ethercat(arp));
  EXPECT_EQ(refusal(arp), "not an EtherCAT frame");
  EXPECT_EQ(refusal(Bytes(13)), "not an EtherCAT frame");
  EXPECT_EQ(refusal({}), "not an EtherCAT frame");
}

TEST(Frame, EachLengthThatLeadsOutIsRefused) {
  const auto good = hex("FFFFFFFFFFFF 101010101010 88A4 0D10 07 00 0000 0000 0100 0000 00 0000");
  EXPECT_EQ(refusal(good), "accepted");
  EXPECT_EQ(refusal(ByteSpan(good).first(15)), "damaged EtherCAT frame: it ends before its header");
  EXPECT_EQ(refusal(ByteSpan(good).first(28)), "damaged EtherCAT frame: it announces 13 bytes and has 12");
  auto bad = good;
  bad[15] = 0x40;
  EXPECT_EQ(refusal(bad), "damaged EtherCAT frame: it is of type 4, not 1");
  bad = good;
  bad[14] = 0x0B;
  EXPECT_EQ(refusal(bad), "damaged EtherCAT frame: a datagram begins beyond its end");
  bad = good;
  bad[22] = 2;
  EXPECT_EQ(refusal(bad), "damaged EtherCAT frame: a datagram of 2 bytes extends beyond its end");
  bad = good;
  bad[23] = 0x80;
  EXPECT_EQ(refusal(bad), "damaged EtherCAT frame: a datagram begins beyond its end");
}

TEST(Frame, CommandsHaveNamesAndDirections) {
  EXPECT_EQ(name(Command::aprd), "APRD");
  EXPECT_EQ(name(Command::frmw), "FRMW");
  EXPECT_EQ(name(static_cast<Command>(15)), "unknown command");
  EXPECT_TRUE(reads(Command::lrw) && writes(Command::lrw) && is_logical(Command::lrw));
  EXPECT_TRUE(reads(Command::fprd) && !writes(Command::fprd) && !is_logical(Command::fprd));
  EXPECT_TRUE(writes(Command::bwr) && !reads(Command::bwr));
  EXPECT_FALSE(reads(Command::nop) || writes(Command::nop));
}

RC_GTEST_PROP(Frame, WhatIsWrittenIsReadBack, (std::vector<Bytes> parts)) {
  std::array<std::uint8_t, kMaxFrame> buffer;
  buffer.fill(0xEE);
  FrameWriter writer(buffer, kSource);
  std::vector<Bytes> taken;
  for (const auto& part : parts) {
    const auto number = taken.size();
    if (writer.add(Command::lwr, static_cast<std::uint8_t>(number),
                   0x8765'4321U + static_cast<std::uint32_t>(number), part))
      taken.push_back(part);
  }
  if (writer.empty()) RC_DISCARD("none");
  const auto frame = writer.finish();
  RC_ASSERT(frame.size() >= kMinFrame);
  const auto read = datagrams(frame);
  RC_ASSERT(read.size() == taken.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    RC_ASSERT(Bytes(read[i].data.begin(), read[i].data.end()) == taken[i]);
    RC_ASSERT(read[i].index == static_cast<std::uint8_t>(i));
    RC_ASSERT(read[i].address == 0x8765'4321U + i);
    RC_ASSERT(read[i].working_counter == 0U);
  }
}

RC_GTEST_PROP(Frame, NoInputLeadsOutOfItself, (Bytes body)) {
  Bytes frame = hex("FFFFFFFFFFFF 101010101010 88A4");
  if (body.size() > 1) body[1] = static_cast<std::uint8_t>((body[1] & 7U) | 0x10U);
  frame.insert(frame.end(), body.begin(), body.end());
  auto reader = FrameReader::open(frame);
  if (!reader) return;
  while (const auto datagram = reader->next())
    RC_ASSERT(datagram->data.data() + datagram->data.size() + 2 <= frame.data() + frame.size());
}

}  // namespace
}  // namespace servoctl::ethercat
