// A drive with habits of its own against its data sheet, over CAN: what `eds verify` finds.
#include "dictionary_check_fixture.hpp"
#include "settings/dictionary_verdict.hpp"

namespace servoctl::settings {
namespace {

TEST_F(DictionaryCheckTest, FindsNothingAtADriveThatIsAsTheFileSays) {
  EXPECT_EQ(listed_text(found()), "");
  EXPECT_EQ(listed_text(found({.factory = true})), "");
  const auto checked = check();
  EXPECT_EQ(checked->entries, family.dictionary.entry_count());
  EXPECT_GT(checked->answered, 500U);
  EXPECT_TRUE(node().objects.writes.empty());
}

TEST_F(DictionaryCheckTest, ASettingMayHaveAnotherValueThanItsDefault) {
  const ObjectAddress setting{0x6065, 0};
  ASSERT_TRUE(file.dictionary.find(setting)->default_value);
  node().objects.values[setting] = {1, 0, 0, 0};
  EXPECT_EQ(listed_text(found()), "");
  EXPECT_EQ(check()->not_default, 1U);
  EXPECT_EQ(listed_text(found({.factory = true})), "0x6065:0 default\n");
}

TEST_F(DictionaryCheckTest, ADriveThatFallsSilentEndsIt) {
  node().dies_after = 300;
  const auto checked = check();
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().code, Errc::timeout);
}

TEST_F(DictionaryCheckTest, AnEmergencyEndsTheReads) {
  node().objects.values[{0x2F00, 0}] = {0};
  od::Object own;
  own.index = 0x2F00;
  auto& entry = own.entries.emplace_back();
  entry.address = {0x2F00, 0};
  entry.name = "own";
  entry.type = od::DataType::u8;
  file.dictionary.add(own);
  node().alarming = {{0x2F01, 0}};
  const auto checked = check();
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().code, Errc::refused);
  EXPECT_NE(checked.error().message.text().find("EMCY 8130h"), std::string::npos)
      << checked.error().message.text();
  EXPECT_TRUE(check({.listed_only = true}));
}

TEST_F(DictionaryCheckTest, AnEmergencyThatIsResetAtOnceEndsTheReadsToo) {
  node().alarming = {{0x6083, 0}};
  node().resets_alarms = true;
  const auto checked = check({.listed_only = true});
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().code, Errc::refused);
}

TEST_F(DictionaryCheckTest, WhatIsNotListedIsNotAskedForWhileTheDriveIsEnabled) {
  node().objects.values[{0x6041, 0}] = {0x37, 0x02};
  const auto checked = check();
  ASSERT_TRUE(checked);
  EXPECT_EQ(checked->probed, 0U);
  ASSERT_EQ(desk.notices.size(), 1U);
  EXPECT_NE(desk.notices[0].text().find("is enabled"), std::string::npos);
}

TEST_F(DictionaryCheckTest, AnswersOfAlwaysFourBytesAreNoOtherSizes) {
  for (auto& [object, bytes] : node().objects.values)
    if (bytes.size() < 4) bytes.resize(4);
  EXPECT_EQ(listed_text(found()), "");
  ASSERT_FALSE(desk.notices.empty());
  EXPECT_NE(desk.notices[0].text().find("four bytes"), std::string::npos);
}

TEST_F(DictionaryCheckTest, AnAnswerThatIsLostOnceIsNoDifference) {
  node().late_once = {{0x6065, 0}};
  EXPECT_EQ(listed_text(found()), "");
}

TEST_F(DictionaryCheckTest, AnEmptyErrorHistoryIsNotMissing) {
  auto* history = file.dictionary.object(0x1003);
  ASSERT_NE(history, nullptr);
  ASSERT_GT(history->entries.size(), 1U);
  node().objects.values[{0x1003, 0}] = {0};
  for (const auto& entry : history->entries)
    if (entry.address.sub != 0) node().objects.values.erase(entry.address);
  EXPECT_EQ(listed_text(found()), "");
}

TEST_F(DictionaryCheckTest, WhatTheDriveCannotTransferIsNotCalledUnreadable) {
  const ObjectAddress object{0x6065, 0};
  node().objects.unsupported.insert(object);
  const auto checked = check();
  ASSERT_TRUE(checked);
  EXPECT_TRUE(checked->findings.empty());
  ASSERT_EQ(checked->unchecked.size(), 1U);
  EXPECT_EQ(checked->unchecked[0].object, object);
}

TEST_F(DictionaryCheckTest, WhatIsNotListedIsNotAskedForWhileAnotherAxisIsEnabled) {
  node().objects.values[{0x6841, 0}] = {0x37, 0x02};
  const auto checked = check();
  ASSERT_TRUE(checked);
  EXPECT_EQ(checked->probed, 0U);
}

TEST_F(DictionaryCheckTest, ADriveThatAnswersWhateverItIsAskedForIsNotProbed) {
  node().objects.answers_all = true;
  const auto checked = check();
  ASSERT_TRUE(checked);
  EXPECT_EQ(checked->probed, 0U);
  ASSERT_EQ(desk.notices.size(), 1U);
  EXPECT_NE(desk.notices[0].text().find("answers reads of any object"), std::string::npos);
}

TEST_F(DictionaryCheckTest, JunitHasAFailureForANodeThatWasNotCompared) {
  const auto silence = make_error(Errc::timeout, "no answer");
  const auto xml = report::junit_xml({dictionary_test(9, silence)});
  EXPECT_NE(xml.find("eds verify node 9"), std::string::npos) << xml;
  EXPECT_NE(xml.find("failures=\"1\""), std::string::npos) << xml;
  EXPECT_NE(xml.find("no answer"), std::string::npos) << xml;
}

TEST_F(DictionaryCheckTest, JunitHasACaseForEachEntryAndEachExtraObject) {
  node().objects.values.erase({0x6065, 0});
  node().objects.values[{0x2006, 0}] = {0};
  auto checked = check();
  ASSERT_TRUE(checked);
  const auto xml = report::junit_xml({dictionary_test(file, *checked)});
  EXPECT_NE(xml.find("failures=\"" + std::to_string(checked->findings.size()) + "\""), std::string::npos);
  EXPECT_NE(xml.find("name=\"0x6065:0\""), std::string::npos);
  EXPECT_NE(xml.find("<failure message=\"missing: file: u32 rw, drive: 06020000h\""), std::string::npos)
      << xml.substr(0, 500);
}

}  // namespace
}  // namespace servoctl::settings
