#include "ethercat/sii_image.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <utility>

#include "sii_images.hpp"

namespace servoctl::ethercat {
namespace {

using Strings = std::vector<std::string>;

TEST(SiiImage, TellsWhatTheSlaveIs) {
  const auto image = parse_sii(full_sii());
  EXPECT_EQ(image.doubts, Strings{});
  EXPECT_FALSE(image.is_empty());
  EXPECT_EQ(image.alias, 5);
  EXPECT_EQ(image.vendor, 0x6AU);
  EXPECT_EQ(image.product, 0x0041'4B44U);
  EXPECT_EQ(image.revision, 2U);
  EXPECT_EQ(image.serial, 0x9983'0093U);
  EXPECT_EQ(image.bootstrap, (SiiMailbox{0x1000, 128, 0x1080, 128}));
  EXPECT_EQ(image.mailbox, (SiiMailbox{0x1800, 1024, 0x1C00, 1024}));
  EXPECT_EQ(image.protocols, kProtocolEoe | kProtocolCoe | kProtocolFoe);
  EXPECT_EQ(image.size, 2048U);
  EXPECT_EQ(image.strings, (Strings{"AKD", "Drive", "DcSync", ""}));
  EXPECT_EQ(image.name, "Drive");
  EXPECT_EQ(image.order, "AKD");
  EXPECT_EQ(image.group, "Drive");
  EXPECT_TRUE(image.has_general);
  EXPECT_EQ(image.coe, kCoeSdo | kCoeAssign | kCoeConfigure | kCoeUploadAtStart | kCoeCompleteAccess);
}

TEST(SiiImage, TellsItsSyncManagersAndPdos) {
  const auto image = parse_sii(full_sii());
  EXPECT_EQ(image.fmmu_use, (Bytes{1, 2, 3, 0xFF}));
  ASSERT_EQ(image.sync_managers.size(), 4U);
  const auto* outputs = image.sync_manager(SiiSyncManager::Use::outputs);
  ASSERT_NE(outputs, nullptr);
  EXPECT_EQ(outputs->start, 0x1100);
  EXPECT_EQ(outputs->control, 0x24);
  EXPECT_EQ(outputs->enable, 1);
  EXPECT_EQ(image.sync_manager(SiiSyncManager::Use::mailbox_in)->length, 1024);
  ASSERT_EQ(image.tx_pdos.size(), 2U);
  EXPECT_EQ(image.tx_pdos[0].index, 0x1A01);
  EXPECT_EQ(image.tx_pdos[0].sync_manager, 0xFF);
  EXPECT_EQ(image.tx_pdos[0].name, "Drive");
  ASSERT_EQ(image.tx_pdos[0].entries.size(), 1U);
  EXPECT_EQ(image.tx_pdos[0].entries[0].object, (ObjectAddress{0x6041, 0}));
  EXPECT_EQ(image.tx_pdos[0].entries[0].name, "AKD");
  EXPECT_EQ(image.tx_pdos[1].flags, 0x10);
  EXPECT_EQ(image.tx_pdos[1].sync_manager, 3);
  ASSERT_EQ(image.rx_pdos.size(), 1U);
  EXPECT_EQ(image.rx_pdos[0].bits(), 24U);
  EXPECT_EQ(image.rx_pdos[0].entries[1].object.index, 0) << "a gap";
  ASSERT_EQ(image.dc_modes.size(), 1U);
  EXPECT_EQ(image.dc_modes[0].name, "DcSync");
  EXPECT_EQ(image.dc_modes[0].activate, 0x0300);
}

TEST(SiiImage, ItsChecksumIsThatOfRealSlaves) {
  // First words of EK1100, EL2828, EL2262, a ClipX and an AKD: dumps/ of ethercrab (MIT or Apache-2.0).
  EXPECT_EQ(sii_checksum(hex("000D000000000000000000000000")), 0x46);
  EXPECT_EQ(sii_checksum(hex("040100000000FF00000000000000")), 0xE2);
  EXPECT_EQ(sii_checksum(hex("0605000010000100000000000000")), 0x2B);
  EXPECT_EQ(sii_checksum(hex("060000CCE8030000000000000000")), 0xB7);
  EXPECT_EQ(sii_checksum(hex("0900000800000000000000000000")), 0x10);
}

TEST(SiiImage, MailboxesThatCannotBeUsedAreADoubt) {
  EXPECT_EQ((SiiMailbox{0x1000, 128, 0x1080, 128}).doubt(), "");
  EXPECT_EQ(SiiMailbox{}.doubt(), "");
  EXPECT_EQ((SiiMailbox{0x1000, 15, 0x1080, 128}).doubt(), "a mailbox has 15 bytes, an SDO needs 16");
  EXPECT_EQ((SiiMailbox{0x1000, 128, 0x2000, 1487}).doubt(), "a mailbox has 1487 bytes, a frame holds 1486");
  EXPECT_EQ((SiiMailbox{0x1000, 128, 0x0800, 128}).doubt(), "a mailbox overlaps the registers");
  EXPECT_EQ((SiiMailbox{0x1000, 129, 0x1080, 128}).doubt(), "its mailboxes overlap");
  EXPECT_EQ((SiiMailbox{0x1080, 128, 0x1000, 129}).doubt(), "its mailboxes overlap");
  auto bytes = full_sii();
  bytes[0x33] = 0xFF;  // The size of the first.
  EXPECT_EQ(parse_sii(bytes).doubts, (Strings{"a mailbox has 65280 bytes, a frame holds 1486"}));
}

TEST(SiiImage, ABadChecksumIsADoubtAndTheRestIsReadAllTheSame) {
  auto bytes = full_sii();
  bytes[14] = 0x77;
  const auto image = parse_sii(bytes);
  EXPECT_EQ(image.doubts, (Strings{"the checksum of its first words is 77h and should be 9Dh"}));
  EXPECT_EQ(image.name, "Drive");
}

TEST(SiiImage, AnEmptyMemoryIsTold) {
  const auto erased = parse_sii(Bytes(2048, 0xFF));
  EXPECT_TRUE(erased.is_empty());
  EXPECT_EQ(erased.doubts, (Strings{"it is empty: no identity, no mailboxes"}));
  Bytes zeros(2048);
  zeros[0] =
      0x4F;  // As dumps/issue-286-empty-eeprom-example.bin of ethercrab: words of the chip, then nothing.
  zeros[4] = 0xCF;
  const auto blank = parse_sii(zeros);
  EXPECT_TRUE(blank.is_empty());
  EXPECT_EQ(blank.doubts, (Strings{"it is empty: no identity, no mailboxes"}));
}

TEST(SiiImage, EachWayOfEndingTooEarlyIsTold) {
  const auto full = full_sii();
  const auto doubts = [&](std::size_t size) { return parse_sii(ByteSpan(full).first(size)).doubts; };
  EXPECT_EQ(doubts(0), (Strings{"it ends after 0 bytes, before its first category"}));
  EXPECT_EQ(doubts(127), (Strings{"it ends after 127 bytes, before its first category"}));
  EXPECT_EQ(doubts(128), (Strings{"its categories have no end mark"}));
  EXPECT_EQ(doubts(130), (Strings{"it ends within the header of a category"}));
  EXPECT_EQ(doubts(140), (Strings{"its category 10 announces 20 bytes and has 8"}));
  auto zero = full;
  std::fill(zero.begin() + 128, zero.end(), std::uint8_t{0});
  EXPECT_EQ(parse_sii(zero).doubts, (Strings{"its categories are not terminated"}));
}

TEST(SiiImage, CategoriesThatSayTooMuchAreTold) {
  const auto with = [](std::string_view category) {
    auto bytes = full_sii();
    bytes.resize(128);
    const auto more = hex(category);
    bytes.insert(bytes.end(), more.begin(), more.end());
    return parse_sii(bytes);
  };
  EXPECT_EQ(with("0A00 0200 03 01 41 05 FFFF").doubts, (Strings{"it announces 3 strings and has 1"}));
  EXPECT_EQ(with("1E00 0100 0000 FFFF").doubts, (Strings{"its general category is too short"}));
  EXPECT_EQ(with("2900 0100 0000 FFFF").doubts, (Strings{"its list of sync managers is truncated"}));
  EXPECT_EQ(with("3200 0400 011A 02 FF 00 00 0000 FFFF").doubts,
            (Strings{"its PDO 1A01h announces 2 entries and has 0"}));
  EXPECT_EQ(with("3300 0100 011A FFFF").doubts, (Strings{"its list of PDOs is truncated"}));
  EXPECT_EQ(with("3C00 0100 0000 FFFF").doubts, (Strings{"its list of DC modes is truncated"}));
  EXPECT_EQ(with("1E00 0300 09 00 09 09 00 00 FFFF").name, "") << "a string that is not there";
}

RC_GTEST_PROP(SiiImage, NoImageIsReadBeyondItsEnd,
              (std::vector<std::pair<std::uint8_t, std::uint8_t>> changes)) {
  auto bytes = full_sii();
  for (const auto& [place, value] : changes) bytes[128 + place % (bytes.size() - 128)] = value;
  if (!changes.empty()) bytes.resize(bytes.size() - changes.front().first % 128);
  const auto image = parse_sii(bytes);
  RC_ASSERT(image.vendor == 0x6AU || bytes.size() < 128);
}

}  // namespace
}  // namespace servoctl::ethercat
