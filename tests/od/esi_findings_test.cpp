#include <gtest/gtest.h>

#include "tests/od/esi_support.hpp"

using namespace servoctl;
using namespace servoctl::od;

namespace {

struct Case {
  std::string_view rule;
  std::string objects;
  std::uint32_t line;
};

}  // namespace

TEST(EsiFindings, EachNamesItsLineAndTheRestOfTheFileIsUsed) {
  const auto good = esi_object("#x3000", "UINT");
  const Case cases[] = {
      {"bad-index", esi_object("x2000", "UINT"), 5},
      {"bad-index", esi_object("#x12000", "UINT"), 5},
      {"duplicate-object", good + esi_object("#x3000", "UINT"), 6},
      {"unknown-data-type", esi_object("#x2000", "DT2000"), 5},
      {"missing-data-type", esi_object("#x2000", ""), 5},
      {"unknown-access-type", esi_object("#x2000", "UINT", "", "r"), 5},
      {"missing-access-type", "<Object><Index>#x2000</Index><Name>A</Name><Type>UINT</Type></Object>", 5},
      {"missing-name",
       "<Object><Index>#x2000</Index><Type>UINT</Type><Flags><Access>ro</Access></Flags></Object>", 5},
      {"bad-value", esi_object("#x2000", "UINT", "<DefaultValue>65536</DefaultValue>"), 5},
      {"bad-value", esi_object("#x2000", "UINT", "<DefaultValue>#x</DefaultValue>"), 5},
      {"bad-value", esi_object("#x2000", "UINT", "<DefaultData>1</DefaultData>"), 5},
      {"data-length", esi_object("#x2000", "UINT", "<DefaultData>010001</DefaultData>"), 5},
      {"limit-outside-type", esi_object("#x2000", "UINT", "<MinValue>-1</MinValue>"), 5},
      {"limits-crossed", esi_object("#x2000", "UINT", "<MinValue>5</MinValue><MaxValue>4</MaxValue>"), 5},
      {"default-out-of-limits",
       esi_object("#x2000", "UINT", "<MinValue>5</MinValue><DefaultData>0400</DefaultData>"), 5},
      {"unknown-mapping",
       "<Object><Index>#x2000</Index><Name>A</Name><Type>UINT</Type><Flags><Access>ro</Access>"
       "<PdoMapping>X</PdoMapping></Flags></Object>",
       5},
      {"bit-size",
       "<Object><Index>#x2000</Index><Name>A</Name><Type>UINT</Type><BitSize>32</BitSize><Flags><Access>ro</Access>"
       "</Flags></Object>",
       5},
  };
  for (const auto& one : cases) {
    const auto file =
        read_good(esi_objects(one.rule == "duplicate-object" ? one.objects : one.objects + "\n" + good));
    const auto* found = finding(file, one.rule);
    ASSERT_NE(found, nullptr) << one.rule << ' ' << one.objects;
    EXPECT_EQ(found->line, one.line) << one.rule;
    EXPECT_FALSE(found->remedy.empty());
    EXPECT_NE(file.sheet.dictionary.object(0x3000), nullptr) << one.rule;
  }
}

TEST(EsiFindings, WhatIsNotKnownToBeWritableIsReadOnly) {
  const auto file =
      read_good(esi_objects(esi_object("#x2000", "UINT", "", "write") +
                            "<Object><Index>#x2001</Index><Name>A</Name><Type>UINT</Type></Object>"));
  EXPECT_EQ(file.sheet.dictionary.find({0x2000, 0})->access, Access::ro);
  EXPECT_EQ(file.sheet.dictionary.find({0x2001, 0})->access, Access::ro);
}

TEST(EsiFindings, HexadecimalOfASignedTypeIsItsTwosComplement) {
  const auto file = read_good(esi_objects(esi_object(
      "#x2000", "DINT",
      "<MinValue>#x80000000</MinValue><MaxValue>#x7FFFFFFF</MaxValue><DefaultValue>-7</DefaultValue>")));
  const auto* entry = file.sheet.dictionary.find({0x2000, 0});
  EXPECT_EQ(std::get<std::int64_t>(entry->low->value), -2147483648LL);
  EXPECT_EQ(std::get<std::int64_t>(entry->default_value->value), -7);
  EXPECT_EQ(finding(file, "limits-crossed"), nullptr);
}

TEST(EsiFindings, PdosAreHeldAgainstTheDictionaryAndTheSyncManagers) {
  const auto file = read_good(esi_objects(
      esi_object("#x2000", "UINT"), {},
      "<Sm/><Sm/><Sm DefaultSize=\"9\">Outputs</Sm><RxPdo Sm=\"2\"><Index>#x1600</Index>\n"
      "<Entry><Index>#x2000</Index><BitLen>8</BitLen></Entry>\n<Entry><Index>#x2001</Index><BitLen>8</BitLen></Entry>\n"
      "<Entry><Index>0</Index><BitLen>8</BitLen></Entry></RxPdo><RxPdo><Index>#x1600</Index></RxPdo>"));
  ASSERT_NE(finding(file, "mapping-length"), nullptr);
  EXPECT_EQ(finding(file, "mapping-length")->line, 8U);
  ASSERT_NE(finding(file, "mapping-absent"), nullptr);
  EXPECT_EQ(finding(file, "mapping-absent")->line, 9U);
  ASSERT_NE(finding(file, "sync-manager-size"), nullptr);
  EXPECT_EQ(finding(file, "sync-manager-size")->message,
            "DefaultSize is 9 bytes, but the PDOs assigned to sync manager 2 have 3");
  EXPECT_NE(finding(file, "duplicate-pdo"), nullptr);
}

TEST(EsiFindings, AMailboxIsWithinItsOwnBoundsAndThereWhereTheDeviceSpeaksCoe) {
  const auto file = read_good(esi_objects(
      esi_object("#x2000", "UINT"), {},
      "<Sm MinSize=\"34\" MaxSize=\"64\" DefaultSize=\"128\">MBoxOut</Sm><Mailbox><CoE/></Mailbox>"));
  EXPECT_NE(finding(file, "mailbox-size"), nullptr);
  ASSERT_NE(finding(file, "missing-mailbox"), nullptr);
  EXPECT_NE(finding(file, "missing-mailbox")->message.find("MBoxIn"), std::string::npos);
}

TEST(EsiFindings, TheIdentityOfTheDeviceGoesBeforeThatOfItsObjects) {
  const auto file = read_good(esi_objects(
      esi_object("#x1018", "DT1018",
                 "<SubItem><Name>p</Name><Info><DefaultValue>50</DefaultValue></Info></SubItem>", "ro"),
      "<DataType><Name>DT1018</Name><SubItem><SubIdx>2</SubIdx><Name>p</Name><Type>UDINT</Type></SubItem></DataType>"));
  EXPECT_EQ(std::get<std::uint64_t>(file.sheet.dictionary.find({0x1018, 2})->default_value->value), 0x2000U);
  EXPECT_NE(finding(file, "identity-differs"), nullptr);
}

TEST(EsiFindings, ValuesOfAStructureFindTheirEntryByName) {
  const std::string types =
      "<DataType><Name>A</Name><SubItem><SubIdx>0</SubIdx><Name>n</Name><Type>USINT</Type></SubItem>"
      "<SubItem><SubIdx>1</SubIdx><Name>one</Name><Type>UINT</Type></SubItem>"
      "<SubItem><SubIdx>2</SubIdx><Name>two</Name><Type>UINT</Type></SubItem></DataType>";
  const auto file = read_good(esi_objects(
      esi_object("#x2000", "A",
                 "<SubItem><Name>two</Name><Info><DefaultValue>2</DefaultValue></Info></SubItem>"
                 "<SubItem><Name>three</Name><Info><DefaultValue>3</DefaultValue></Info></SubItem>"),
      types));
  EXPECT_FALSE(file.sheet.dictionary.find({0x2000, 1})->default_value);
  EXPECT_EQ(std::get<std::uint64_t>(file.sheet.dictionary.find({0x2000, 2})->default_value->value), 2U);
  EXPECT_NE(finding(file, "sub-item-without-type"), nullptr);
}

TEST(EsiFindings, DataThatIsLongerThanItsTypeIsNoValueUnlessOnlyZerosGo) {
  const auto file = read_good(esi_objects(esi_object("#x2000", "UINT", "<DefaultData>010001</DefaultData>") +
                                          esi_object("#x2001", "UINT", "<DefaultData>010000</DefaultData>")));
  EXPECT_FALSE(file.sheet.dictionary.find({0x2000, 0})->default_value);
  EXPECT_TRUE(file.sheet.dictionary.find({0x2001, 0})->default_value);
  EXPECT_EQ(file.sheet.error_count(), 1U);
}
