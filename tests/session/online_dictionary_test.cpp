#include "session/online_dictionary.hpp"

#include <gtest/gtest.h>

#include "tests/session/ethercat_world.hpp"

namespace servoctl::session {
namespace {

class OnlineDictionaryTest : public EtherCatTest {
 protected:
  static std::string p20() { return source_dir() + "/tests/cli/data/p20.xml"; }
};

ethercat::CoeEntry described(std::uint16_t type, std::uint16_t bits, std::uint16_t access) {
  return {{0x2000, 1}, type, bits, access, "Entry"};
}

TEST_F(OnlineDictionaryTest, IsWhatTheDriveSaysOfItsObjects) {
  open(p20() + "@1");
  const auto online = read_online_dictionary(*session_, 1);
  ASSERT_TRUE(online) << online.error().message.text();
  EXPECT_TRUE(online->left_out.empty());
  const auto& own = port_->cell().profiles.front()->dictionary;
  ASSERT_EQ(online->sheet.dictionary.objects().size(), own.objects().size());
  EXPECT_EQ(online->sheet.dictionary.entry_count(), own.entry_count());
  for (const auto& object : own.objects())
    for (const auto& entry : object.entries) {
      const auto* told = online->sheet.dictionary.find(entry.address);
      ASSERT_NE(told, nullptr) << to_string(entry.address);
      EXPECT_EQ(told->name, entry.name);
      EXPECT_EQ(told->type, entry.type) << to_string(entry.address);
      EXPECT_EQ(told->access, entry.access) << to_string(entry.address);
      EXPECT_EQ(told->pdo, entry.pdo) << to_string(entry.address);
    }
  EXPECT_EQ(online->sheet.device.vendor_number, 0xFABU);
  EXPECT_EQ(online->sheet.device.product_number, 0x2000U);
  EXPECT_EQ(online->sheet.device.revision_number, 0x30001U);
  EXPECT_EQ(online->sheet.device.product_name, "P20");
}

TEST_F(OnlineDictionaryTest, IsReadOverLossesToo) {
  open(p20() + "@1");
  ring().faults().loses_every = 9;
  const auto online = read_online_dictionary(*session_, 1);
  ASSERT_TRUE(online) << online.error().message.text();
  EXPECT_EQ(online->sheet.dictionary.entry_count(), port_->cell().profiles.front()->dictionary.entry_count());
}

TEST_F(OnlineDictionaryTest, ADriveWithoutOneSaysSoAndWhatToUseInstead) {
  open("sv2@1");
  const auto online = read_online_dictionary(*session_, 1);
  ASSERT_FALSE(online);
  EXPECT_TRUE(online.error().message.text().starts_with(
      "node 1 does not describe its objects (no SDO information): "))
      << online.error().message.text();
  EXPECT_NE(online.error().hint.text().find("-d FILE.xml"), std::string::npos) << online.error().hint.text();
}

TEST_F(OnlineDictionaryTest, ADriveThatGoesInTheMiddleEndsIt) {
  open(p20() + "@1");
  int asked = 0;
  session_->options().list_progress = [&](std::size_t, std::size_t, TimePoint) {
    if (++asked == 3) ring().power_off(0);
  };
  const auto online = read_online_dictionary(*session_, 1);
  ASSERT_FALSE(online);
  EXPECT_EQ(online.error().code, Errc::timeout) << online.error().message.text();
}

TEST(OnlineEntry, AccessIsThatOfAllStatesAndItsLimitsAreTold) {
  using namespace ethercat;
  constexpr std::uint16_t kRead = kEntryReadPreop | kEntryReadSafeop | kEntryReadOp;
  EXPECT_EQ(online_entry(described(6, 16, kRead))->access, od::Access::ro);
  const auto preop = online_entry(described(6, 16, kRead | kEntryWritePreop | kEntryRxPdo));
  EXPECT_EQ(preop->access, od::Access::rw);
  EXPECT_EQ(preop->note, "can be written in PRE-OP only");
  EXPECT_EQ(preop->pdo, od::PdoMapping::rpdo);
  EXPECT_EQ(online_entry(described(6, 16, kEntryWritePreop | kEntryWriteSafeop | kEntryWriteOp))->access,
            od::Access::wo);
  EXPECT_FALSE(online_entry(described(6, 16, 0)));
}

TEST(OnlineEntry, TypesOfEtherCatAndUnknownOnesAreTakenByTheirBits) {
  constexpr std::uint16_t kRead =
      ethercat::kEntryReadPreop | ethercat::kEntryReadSafeop | ethercat::kEntryReadOp;
  EXPECT_EQ(online_entry(described(0x20, 32, kRead))->type, od::DataType::u32)
      << "a DWORD, no record of CiA 301";
  EXPECT_EQ(online_entry(described(0x30, 1, kRead))->type, od::DataType::boolean);
  const auto own = online_entry(described(0x0801, 16, kRead));
  EXPECT_EQ(own->type, od::DataType::u16);
  EXPECT_EQ(own->note, "type 0801h of the drive, taken as u16");
  EXPECT_EQ(online_entry(described(0x0801, 40, kRead))->type, od::DataType::bytes);
}

}  // namespace
}  // namespace servoctl::session
