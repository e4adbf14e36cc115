// A data sheet against a drive that contradicts it, over CAN: what `eds verify` finds.
#include "settings/dictionary_check.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>
#include <string>

#include "lying_node.hpp"
#include "settings/dictionary_verdict.hpp"
#include "tests/show/audiences.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::settings {
namespace {

using Found = std::set<std::pair<ObjectAddress, Difference>>;

std::string listed_text(const Found& found) {
  std::string out;
  for (const auto& [object, difference] : found)
    out += to_string(object) + " " + std::string(name(difference)) + "\n";
  return out;
}

class DictionaryCheckTest : public testing::Test {
 protected:
  DictionaryCheckTest()
      : standard(drive::load_profile("cia402", kFolders).value()),
        family(drive::load_profile("gsd600", kFolders).value()) {
    file.dictionary = family.dictionary;
    for (const auto& object : family.dictionary.objects())
      for (const auto& entry : object.entries) file.dictionary.find(entry.address)->is_volatile = false;
  }

  LyingNode& node() {
    if (!node_) node_ = std::make_unique<LyingNode>(family.dictionary);
    return *node_;
  }
  Result<DictionaryCheck> check(const CheckOptions& options = {}) {
    desk.session = &*node().session;
    desk.standard = &standard;
    return check_dictionary(desk, 1, file, options);
  }
  Found found(const CheckOptions& options = {}) {
    const auto checked = check(options);
    EXPECT_TRUE(checked) << checked.error().message;
    Found out;
    if (checked)
      for (const auto& each : checked->findings) out.emplace(each.object, each.difference);
    return out;
  }

  drive::Profile standard;
  drive::Profile family;
  od::EdsFile file;
  show::Desk desk;
  std::unique_ptr<LyingNode> node_;
};

TEST_F(DictionaryCheckTest, FindsNothingAtADriveThatIsAsTheFileSays) {
  EXPECT_EQ(listed_text(found()), "");
  EXPECT_EQ(listed_text(found({.factory = true})), "");
  const auto checked = check();
  EXPECT_EQ(checked->entries, family.dictionary.entry_count());
  EXPECT_GT(checked->answered, 500U);
  EXPECT_TRUE(node().objects.writes.empty());
}

/// Makes the file or the drive lie about an entry; false: this entry cannot carry the lie.
using Lie = std::function<bool(LyingNode&, od::EdsFile&, const od::Object&, od::Entry&, Found&)>;

bool is_plain(const od::Object& object) { return object.entries.size() == 1; }

const std::vector<Lie>& lies() {
  static const std::vector<Lie> kLies{
      [](LyingNode& node, od::EdsFile&, const od::Object& object, od::Entry& entry, Found& out) {
        if (!is_plain(object) && entry.address.sub == 0) return false;
        node.objects.values.erase(entry.address);
        out.emplace(entry.address, Difference::missing);
        return true;
      },
      [](LyingNode& node, od::EdsFile&, const od::Object&, od::Entry& entry, Found& out) {
        auto& bytes = node.objects.values[entry.address];
        if (!od::size_of(entry.type) || !od::readable(entry.access)) return false;
        bytes.resize(bytes.size() == 4 ? 2 : bytes.size() + 1);
        out.emplace(entry.address, Difference::size);
        return true;
      },
      [](LyingNode& node, od::EdsFile&, const od::Object&, od::Entry& entry, Found& out) {
        auto& bytes = node.objects.values[entry.address];
        if (!od::size_of(entry.type) || !od::readable(entry.access)) return false;
        bytes.resize(9);  // Segmented.
        out.emplace(entry.address, Difference::size);
        return true;
      },
      [](LyingNode& node, od::EdsFile&, const od::Object&, od::Entry& entry, Found& out) {
        if (!od::readable(entry.access)) {
          node.objects.write_only.erase(entry.address);
        } else {
          node.objects.write_only.insert(entry.address);
        }
        out.emplace(entry.address, Difference::access);
        return true;
      },
      [](LyingNode& node, od::EdsFile&, const od::Object&, od::Entry& entry, Found& out) {
        if (!od::readable(entry.access) || node.objects.values[entry.address].size() != 2) return false;
        entry.type = od::DataType::string;
        entry.default_value = entry.low = entry.high = {};
        node.objects.values[entry.address] = {1, 2};
        out.emplace(entry.address, Difference::type);
        return true;
      },
      [](LyingNode& node, od::EdsFile&, const od::Object&, od::Entry& entry, Found& out) {
        if (!od::readable(entry.access) || !od::size_of(entry.type) || !od::is_integer(entry.type))
          return false;
        entry.access = od::Access::constant;
        entry.low = entry.high = {};
        auto& bytes = node.objects.values[entry.address];
        entry.default_value = od::NodeValue{od::decode(entry.type, bytes).value()};
        bytes.front() ^= 1U;
        out.emplace(entry.address, Difference::default_value);
        return true;
      },
      [](LyingNode& node, od::EdsFile&, const od::Object&, od::Entry& entry, Found& out) {
        if (!od::readable(entry.access) || entry.type != od::DataType::u16) return false;
        entry.default_value = {};
        entry.low = od::NodeValue{od::Value(std::uint64_t{10})};
        entry.high = od::NodeValue{od::Value(std::uint64_t{20})};
        node.objects.values[entry.address] = {static_cast<std::uint8_t>(entry.address.sub % 2 == 0 ? 9 : 21),
                                              0};
        out.emplace(entry.address, Difference::limits);
        return true;
      },
      [](LyingNode& node, od::EdsFile&, const od::Object&, od::Entry& entry, Found& out) {
        if (!od::readable(entry.access)) return false;
        node.silent.insert(entry.address);
        out.emplace(entry.address, Difference::no_answer);
        return true;
      },
      [](LyingNode&, od::EdsFile& sheet, const od::Object& object, od::Entry& entry, Found& out) {
        // The file forgets the entry; the drive's sub 0 counts it.
        if (is_plain(object) || entry.address.sub == 0) return false;
        const auto address = entry.address;
        auto* listed = sheet.dictionary.object(address.index);
        std::erase_if(listed->entries, [&](const od::Entry& each) { return each.address == address; });
        out.emplace(address, Difference::unlisted);
        return true;
      },
      [](LyingNode& node, od::EdsFile& sheet, const od::Object& object, od::Entry&, Found& out) {
        // The drive has one object more, beside one of the file.
        const ObjectAddress beside{static_cast<std::uint16_t>(object.index + 1), 0};
        if (sheet.dictionary.object(beside.index) != nullptr || beside.index % 0x1000 == 0 ||
            beside.index < 0x2000)
          return false;
        node.objects.values[beside] = {0, 0};
        out.emplace(beside, Difference::unlisted);
        return true;
      },
  };
  return kLies;
}

/// Sub 0 decides what is asked for beside it, and the numbers decide which drive it is.
bool may_carry_a_lie(const od::Object& object, const od::Entry& entry) {
  return entry.address.index >= 0x2000 && (is_plain(object) || entry.address.sub != 0) &&
         entry.address != ObjectAddress{0x6041, 0};
}

TEST_F(DictionaryCheckTest, FindsEachOfTwoHundredSeededLiesAndNothingElse) {
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U}) {
    std::mt19937 random(seed);
    file.dictionary = family.dictionary;
    node_.reset();
    std::vector<ObjectAddress> places;
    for (const auto& object : family.dictionary.objects())
      for (const auto& entry : object.entries)
        if (may_carry_a_lie(object, entry)) places.push_back(entry.address);
    std::shuffle(places.begin(), places.end(), random);
    Found expected;
    std::vector<std::size_t> told(lies().size());
    for (std::size_t i = 0; i < places.size() && expected.size() < 200; ++i) {
      auto* entry = file.dictionary.find(places[i]);
      const auto* object = family.dictionary.object(places[i].index);
      for (std::size_t k = 0; entry != nullptr && k < lies().size(); ++k) {
        const auto kind = (i + k) % lies().size();
        const auto before = expected.size();
        if (!lies()[kind](node(), file, *object, *entry, expected)) continue;
        if (expected.size() > before) ++told[kind];
        break;
      }
    }
    ASSERT_EQ(expected.size(), 200U);
    for (std::size_t kind = 0; kind < told.size(); ++kind)
      EXPECT_GT(told[kind], 0U) << "lie " << kind << " with seed " << seed;
    EXPECT_EQ(listed_text(found()), listed_text(expected)) << "seed " << seed;
  }
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
  EXPECT_NE(checked.error().message.find("EMCY 8130h"), std::string::npos) << checked.error().message;
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
  EXPECT_NE(desk.notices[0].find("is enabled"), std::string::npos);
}

TEST_F(DictionaryCheckTest, AnswersOfAlwaysFourBytesAreNoOtherSizes) {
  for (auto& [object, bytes] : node().objects.values)
    if (bytes.size() < 4) bytes.resize(4);
  EXPECT_EQ(listed_text(found()), "");
  ASSERT_FALSE(desk.notices.empty());
  EXPECT_NE(desk.notices[0].find("four bytes"), std::string::npos);
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
  EXPECT_NE(desk.notices[0].find("answers reads of any object"), std::string::npos);
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
