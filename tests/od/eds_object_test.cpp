// How sections become objects.
#include <fmt/format.h>

#include <algorithm>

#include "tests/od/eds_support.hpp"

namespace servoctl::od {
namespace {

/// An object with these sub-indexes as they are written.
EdsFile with_subs(const std::vector<std::string>& subs) {
  std::string text = fmt::format("[2000]\nParameterName=X\nObjectType=9\nSubNumber={}\n", subs.size());
  for (const auto& sub : subs) text += variable("2000sub" + sub, "5", "");
  return read(text);
}

TEST(EdsSubIndex, IsDecimalOnlyWhereNoNumberIsMissing) {
  EXPECT_EQ(findings(with_subs(numbers(0, 9))), Rules{});
  EXPECT_EQ(findings(with_subs(numbers(1, 10))), Rules{"5:1 decimal-sub-index"});
  EXPECT_EQ(findings(with_subs(numbers(2, 10))), Rules{});
  EXPECT_NE(with_subs(numbers(2, 10)).dictionary.find({0x2000, 0x10}), nullptr);
  const auto file = with_subs({"10", "9", "8", "7", "6", "5", "4", "3", "2", "1"});
  EXPECT_EQ(findings(file), Rules{"50:1 decimal-sub-index"});
  EXPECT_EQ(file.dictionary.object(0x2000)->entries.back().address.sub, 10);
  EXPECT_EQ(file.diagnostics.front().message,
            "the sub-indexes of 2000 are taken as decimal: in hexadecimal some are missing");
  auto one_is_hex = numbers(1, 10);
  one_is_hex.emplace_back("1A");
  EXPECT_EQ(findings(with_subs(one_is_hex)), Rules{});
}

TEST(EdsSubIndex, IsDecimalWhereHexadecimalIsTooHigh) {
  const auto file = with_subs({"1", "100"});
  EXPECT_EQ(findings(file), Rules{"5:1 decimal-sub-index"});
  EXPECT_NE(file.dictionary.find({0x2000, 100}), nullptr);
  EXPECT_NE(with_subs({"100", "1"}).dictionary.find({0x2000, 100}), nullptr);
  EXPECT_NE(with_subs({"255"}).dictionary.find({0x2000, 255}), nullptr);
}

TEST(EdsSubIndex, ThatIsTooHighAmongHexadecimalOnesIsToldAndLeftOut) {
  const auto file = with_subs({"1A", "100"});
  EXPECT_EQ(findings(file), (Rules{"4:11 wrong-sub-number", "10:1 unknown-section"}));
  EXPECT_EQ(file.diagnostics.back().message, "[2000sub100]: the sub-index is above FF");
  EXPECT_EQ(file.dictionary.entry_count(), 1U);
  EXPECT_NE(with_subs({"FF"}).dictionary.find({0x2000, 255}), nullptr);
}

TEST(EdsSubNumber, IsTheNumberOfSections) {
  const auto with = [](const char* number) {
    return findings(read("[2000]\nParameterName=X\nObjectType=9\nSubNumber=" + std::string(number) + "\n" +
                         variable("2000sub0", "5", "") + variable("2000sub9", "5", "")));
  };
  EXPECT_EQ(with("2"), Rules{});
  EXPECT_EQ(with("1"), Rules{"4:11 wrong-sub-number"});
  EXPECT_EQ(with("256"), Rules{"4:11 wrong-sub-number"});
  EXPECT_EQ(with("257"), Rules{"4:11 bad-number"});
  EXPECT_EQ(with(""), Rules{"1:1 missing-sub-number"});
}

TEST(EdsObject, WithoutSubIndexesWhereItsTypeHasThemIsToldAsLeftOut) {
  for (const auto* number : {"", "SubNumber=0\n", "SubNumber=3\n"}) {
    const auto file = read("[2000]\nParameterName=X\nObjectType=8\nDataType=8\nAccessType=rw\n" +
                           std::string(number) + variable("2001", "7", ""));
    EXPECT_EQ(findings(file), Rules{"1:1 no-sub-indexes"}) << number;
    EXPECT_EQ(file.dictionary.find({0x2000, 0}), nullptr);
  }
}

TEST(EdsObject, OfEveryPlainCodeHasOneEntry) {
  for (const auto* code : {"2", "5", "7"}) {
    const auto file = read(variable("2000", "7", "ObjectType=" + std::string(code)));
    EXPECT_EQ(findings(file), Rules{}) << code;
    EXPECT_NE(file.dictionary.find({0x2000, 0}), nullptr) << code;
  }
  for (const auto* code : {"6", "8", "9"}) {
    const auto file = read(variable("2000", "7", "ObjectType=" + std::string(code) + "\nSubNumber=0") +
                           variable("2001", "7", ""));
    EXPECT_EQ(findings(file), Rules{"1:1 no-sub-indexes"}) << code;
    EXPECT_EQ(file.dictionary.object(0x2000), nullptr) << code;
  }
}

TEST(EdsObject, WithoutItsOwnSectionHasItsEntries) {
  const auto file = read(variable("2000sub1", "5", "") + variable("2000sub2", "6", ""));
  EXPECT_EQ(findings(file), Rules{"1:1 missing-object"});
  EXPECT_EQ(file.diagnostics.front().message, "[2000sub1] has no section [2000]");
  EXPECT_EQ(file.dictionary.entry_count(), 2U);
  EXPECT_EQ(file.dictionary.find({0x2000, 2})->type, DataType::u16);
}

TEST(EdsObject, OfPlainCodeMayHaveSubIndexes) {
  const auto file = read(variable("2000", "7", "SubNumber=1") + variable("2000sub3", "5", ""));
  EXPECT_EQ(findings(file), Rules{"1:1 var-with-sub-indexes"});
  EXPECT_EQ(file.dictionary.find({0x2000, 0}), nullptr);
  EXPECT_NE(file.dictionary.find({0x2000, 3}), nullptr);
}

TEST(EdsObject, StandsAnywhereInTheFile) {
  const auto file =
      read(variable("3000", "7", "") + variable("2000sub1", "5", "") + variable("1000", "6", "") +
           "[2000]\nParameterName=Late\nObjectType=9\nSubNumber=1\n");
  EXPECT_EQ(findings(file), Rules{});
  ASSERT_EQ(file.dictionary.objects().size(), 3U);
  EXPECT_EQ(file.dictionary.object(0x2000)->name, "Late");
  EXPECT_EQ(file.dictionary.object(0x2000)->entries.size(), 1U);
}

TEST(EdsDuplicate, OfAnySectionIsToldWithTheLineOfTheFirst) {
  const std::string sections[] = {"[DeviceInfo]\nVendorName=a\n", "[DeviceComissioning]\nNodeID=1\n",
                                  "[DummyUsage]\nDummy0001=1\n",  "[2FFFName]\nNrOfEntries=0\n",
                                  variable("2000", "7", ""),      variable("2FFFsub1", "5", "")};
  for (const auto& section : sections) {
    const auto lines = static_cast<std::size_t>(std::count(section.begin(), section.end(), '\n'));
    auto file = read(section + section + variable("2FFF", "7", "SubNumber=1\nObjectType=9") +
                     variable("3000", "7", ""));
    std::erase_if(file.diagnostics,
                  [](const auto& d) { return d.rule == "wrong-sub-number" || d.rule == "no-sub-indexes"; });
    ASSERT_EQ(findings(file), Rules{fmt::format("{}:1 duplicate-section", lines + 1)}) << section;
    const auto name = section.substr(0, section.find(']') + 1);
    EXPECT_EQ(file.diagnostics.front().message,
              name + " appears again, first in line 1; the first one is used");
  }
}

TEST(EdsDuplicate, OfAKeyIsToldHoweverManyKeysThereAre) {
  EXPECT_EQ(findings(read("[2000]\nParameterName=X\nparametername=\nDataType=7\nAccessType=ro\n")),
            (Rules{"1:1 missing-name", "3:15 duplicate-key"}));
  for (const int keys : {1, 12, 13, 30}) {
    std::string more;
    for (int i = 0; i < keys; ++i) more += fmt::format("Key{}=\n", i);
    EXPECT_EQ(findings(read(variable("2000", "7", more + "kEY0=5"))),
              Rules{fmt::format("{}:6 duplicate-key", 5 + keys)});
    EXPECT_EQ(findings(read(variable("2000", "7", more))), Rules{});
  }
}

TEST(EdsDuplicate, IsLookedForInAHundredThousandKeysOnly) {
  std::string text = variable("2FFF", "7", "") + "[Comments]\n";
  for (int i = 0; i < 99'999; ++i) text += fmt::format("a{}=\n", i);
  EXPECT_EQ(findings(read(text + "a0=\n")), Rules{"100006:4 duplicate-key"});
  EXPECT_EQ(findings(read(text + "b=\na0=\n")), Rules{});
}

TEST(EdsText, TellsLinesThatAreNothing) {
  const auto file =
      read("early=1\n" + variable("2000", "7", "=5\nword\n  // no\n<<<<<<<\n======= x\n>>>>>>>\n<<<<<<\n#"));
  EXPECT_EQ(findings(file),
            (Rules{"1:1 stray-line", "6:1 stray-line", "7:1 stray-line", "8:1 foreign-comment",
                   "9:1 merge-marker", "10:1 merge-marker", "11:1 merge-marker", "13:1 foreign-comment"}));
  EXPECT_EQ(file.error_count(), 6U);
  EXPECT_EQ(file.warning_count(), 2U);
}

TEST(EdsText, WithoutAUsableObjectIsRefusedWithTheFirstFinding) {
  const auto file = read_eds("[2000]\nParameterName=X\n", "x.eds");
  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().hint.text(), "x.eds:1:1: error: [2000] has no DataType [missing-data-type]");
  EXPECT_EQ(read_eds("", "x.eds").error().hint.text(), "is it an EDS or DCF file (CiA 306)?");
}

TEST(Diagnostic, OfAWarningSaysSo) {
  EXPECT_EQ(to_string({Severity::warning, 1, 2, "r", "m", "x"}, "f"), "f:1:2: warning: m [r]");
}

}  // namespace
}  // namespace servoctl::od
