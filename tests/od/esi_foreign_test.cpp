#include <gtest/gtest.h>

#include "tests/od/esi_support.hpp"

using namespace servoctl;
using namespace servoctl::od;

namespace {

Error refused(std::string_view text, std::string_view device = {}) {
  const auto file = read_esi(text, "p20.xml", device);
  EXPECT_FALSE(file);
  return file ? Error{} : file.error();
}

/// ASCII in UTF-16 with its byte order mark.
std::string utf16le(std::string_view ascii) {
  std::string out = "\xFF\xFE";
  for (const char c : ascii) {
    out += c;
    out += '\0';
  }
  return out;
}

}  // namespace

TEST(EsiForeign, WhatIsNotWellFormedIsToldWithLineAndColumn) {
  const auto error =
      refused("<?xml version=\"1.0\"?>\n<EtherCATInfo>\n  <Vendor><Id>1</Vendor>\n</EtherCATInfo>\n");
  EXPECT_EQ(error.code, Errc::file);
  EXPECT_EQ(error.line, 3U);
  EXPECT_TRUE(error.message.text().starts_with("p20.xml:3:")) << error.message.text();
  EXPECT_NE(error.message.text().find("an end tag is missing or is not that of its element"),
            std::string::npos)
      << error.message.text();
}

TEST(EsiForeign, AFileThatEndsInTheMiddleSaysSo) {
  const auto whole = esi_objects(esi_object("#x2000", "UINT"));
  const auto error = refused(std::string_view(whole).substr(0, whole.find("<Flags>") + 7));
  EXPECT_NE(error.message.text().find("the file ends in the middle"), std::string::npos)
      << error.message.text();
  for (std::size_t end = 0; end + 2 < whole.size(); ++end)
    EXPECT_FALSE(read_esi(whole.substr(0, end), "p20.xml")) << end;
}

TEST(EsiForeign, OtherXmlIsCalledWhatItIs) {
  EXPECT_EQ(refused("<EtherCATConfig/>").message, "p20.xml: <EtherCATConfig> is not an ESI");
  EXPECT_NE(refused("<EtherCATConfig/>").hint.text().find("ENI"), std::string::npos);
  EXPECT_NE(refused("<ISO15745ProfileContainer/>").hint.text().find("XDD"), std::string::npos);
  EXPECT_EQ(refused("[2000]\nDataType=5\n").message, "p20.xml: this is not XML");
  EXPECT_EQ(refused("").message, "p20.xml: this is not XML");
  EXPECT_EQ(refused(std::string(64, '\x01')).message, "p20.xml: not a text file");
}

TEST(EsiForeign, EntitiesOfTheFileAreNotReplaced) {
  const auto text = esi_text(
      "<RxPdo><Index>#x1600</Index><Entry><Index>#x7000</Index><BitLen>8</BitLen><Name>&c;</Name>"
      "<DataType>USINT</DataType></Entry></RxPdo>",
      "<!DOCTYPE x [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;\"><!ENTITY c \"&b;&b;&b;&b;\">"
      "<!ENTITY d SYSTEM \"file:///etc/passwd\">]>\n");
  const auto file = read_good(text);
  EXPECT_EQ(file.sheet.dictionary.find({0x7000, 0})->name, "&c;");
  EXPECT_NE(finding(file, "document-type"), nullptr);
}

TEST(EsiForeign, MoreTagsThanAnyDeviceHasAreRefusedUnread) {
  std::string text = "<EtherCATInfo>";
  for (int i = 0; i < 4'000'001; ++i) text += "<a/>";
  EXPECT_NE(refused(text).message.text().find("tags are more than any device description has"),
            std::string::npos);
  EXPECT_EQ(refused(std::string(kMostEsiBytes + 1, ' ')).message, "p20.xml: 64 MiB is too large for an ESI");
}

TEST(EsiForeign, ElementsWithinElementsAreNotCountedOnTheStack) {
  std::string text;
  for (int i = 0; i < 200'000; ++i) text += "<a>";
  for (int i = 0; i < 200'000; ++i) text += "</a>";
  EXPECT_EQ(refused(text).message, "p20.xml: <a> is not an ESI");
}

TEST(EsiForeign, LettersAreReadInTheEncodingTheFileDeclares) {
  const auto body = esi_object("#x2000", "UINT");
  const auto head = std::string("<?xml version=\"1.0\" encoding=\"gb2312\"?>\n");
  auto text = esi_objects(body);
  text = head + text.substr(text.find("<EtherCATInfo"));
  const auto at = text.find("<Name>Object");
  text.replace(at, 12, "<Name>\xC8\xC5\xC1\xA6");  // 扰力
  const auto file = read_good(text);
  EXPECT_EQ(file.sheet.dictionary.object(0x2000)->name, "扰力");
  EXPECT_EQ(finding(file, "encoding"), nullptr);
}

TEST(EsiForeign, LettersThatAreNotWhatIsDeclaredAreGuessedAndTold) {
  auto text = esi_objects(esi_object("#x2000", "UINT"));
  text = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n" + text.substr(text.find("<EtherCATInfo"));
  text.replace(text.find("<Name>Object"), 12, "<Name>\xB1\xA7\xD5\xA2\xBF\xD8\xD6\xC6");  // 抱闸控制
  const auto file = read_good(text);
  EXPECT_EQ(file.sheet.dictionary.object(0x2000)->name, "抱闸控制");
  ASSERT_NE(finding(file, "encoding"), nullptr);
  EXPECT_EQ(finding(file, "encoding")->message, "the file is taken as GBK, which is not what it declares");
}

TEST(EsiForeign, Utf16AndAByteOrderMarkAreRead) {
  const auto text = esi_objects(esi_object("#x2000", "UINT"));
  EXPECT_EQ(read_good(utf16le(text)).sheet.dictionary.objects().size(), 1U);
  EXPECT_EQ(read_good("\xEF\xBB\xBF" + text).sheet.dictionary.objects().size(), 1U);
}

TEST(EsiForeign, ADeviceWithNothingToReadIsRefused) {
  EXPECT_EQ(refused(esi_text("")).message,
            "p20.xml: 'P20 drive' has neither a usable object nor a PDO entry");
  EXPECT_EQ(refused("<EtherCATInfo><Descriptions><Devices/></Descriptions></EtherCATInfo>").message,
            "p20.xml: there is no Device in this file");
}
