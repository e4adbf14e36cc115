#include "report/catalogue.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <random>

#include "report/chinese_value.hpp"
#include "report/text_parts.hpp"
#include "report/zh_po.hpp"

namespace servoctl::report {
namespace {

Catalogue small_catalogue() {
  return Catalogue({{"node {} did not answer within {} ms", "节点 {} 在 {} ms 内无应答"},
                    {"node {}: {}", "节点 {}：{}"},
                    {"{} of node {} is also sent with 0x{:X}", "节点 {1} 的 {0} 也以 0x{2} 发送"},
                    {"the drive is in {}", "驱动器处于{}"},
                    {"the drive is in fault", "驱动器故障"},
                    {"fault", "故障"},
                    {"quick stop active", "快速停机"},
                    {"'{}' is not a command", "'{}' 不是命令"},
                    {"{} time{} tried", "尝试了 {} 次{}"},
                    {" (assumed)", "（推定）"},
                    {", at most every {} ms", "，最短间隔 {} ms"},
                    {"write 500ms or 2s", "写成 500ms 或 2s"},
                    {"{}: {}", "{}：{}"},
                    {"{:.1f} mm", "{} 毫米"}});
}

TEST(Catalogue, PutsNumbersAndTextsIntoThePlacesOfTheTranslation) {
  const auto c = small_catalogue();
  EXPECT_EQ(c.translated("node 3 did not answer within 500 ms"), "节点 3 在 500 ms 内无应答");
  EXPECT_EQ(c.translated("TPDO2 of node 3 is also sent with 0x281"), "节点 3 的 TPDO2 也以 0x281 发送");
}

TEST(Catalogue, TranslatesWhatStandsAtAPlaceInTurn) {
  const auto c = small_catalogue();
  EXPECT_EQ(c.translated("node 1: the drive is in quick stop active"), "节点 1：驱动器处于快速停机");
  EXPECT_EQ(c.translated("node 1: the drive is in limbo"), "节点 1：驱动器处于limbo");
}

TEST(Catalogue, TakesTheWholeTextAndThenThePatternWithTheMostLetters) {
  const auto c = small_catalogue();
  EXPECT_EQ(c.translated("the drive is in fault"), "驱动器故障");
  EXPECT_EQ(c.translated("node 2 did not answer within 5 ms: fault"), "节点 2 在 5 ms 内无应答：故障");
}

TEST(Catalogue, TakesNamesOfDataWhereTheProgramHasNoWord) {
  const auto c = small_catalogue();
  const Names names{{"Statusword", "状态字"}, {"fault", "另一个"}};
  EXPECT_EQ(c.translated("node 1: Statusword", &names), "节点 1：状态字");
  EXPECT_EQ(c.translated("node 1: fault", &names), "节点 1：故障");
  EXPECT_EQ(c.translated("node 1: Statusword"), "节点 1：Statusword");
}

TEST(Catalogue, KnowsThatUnitsAreNoEnglish) {
  const Catalogue c(std::vector<PoEntry>{{"turn at {} for {}", "以 {} 转动 {}"}});
  EXPECT_EQ(c.translated("turn at 60 rpm for 300 ms"), "以 60 rpm 转动 300 ms");
}

TEST(Catalogue, TakesASentenceInCapitalsAsOne) {
  const Catalogue c({{"IT IS NOT KNOWN: SWITCH IT OFF", "情况不明：切断电源"}, {"NOT KNOWN", "错"}});
  EXPECT_EQ(c.translated("IT IS NOT KNOWN: SWITCH IT OFF"), "情况不明：切断电源");
  EXPECT_EQ(c.translated("IT IS NOT KNOWN: SWITCH IT OFF (node 1)"), "情况不明：切断电源（node 1）");
  EXPECT_EQ(c.translated("a.txt:3: lift: IT IS NOT KNOWN: SWITCH IT OFF (0x40)"),
            "a.txt:3：lift：情况不明：切断电源（0x40）");
}

/// Of all sentences of the catalogue, whatever the program puts before or behind one.
TEST(Catalogue, KnowsASentenceBehindTheNameOfANodeAnAxisABusAndAFile) {
  const auto entries = parse_po(zh_po(), "zh.po");
  ASSERT_TRUE(entries);
  std::size_t sentences = 0;
  for (const auto& entry : *entries) {
    constexpr std::size_t kWords = 3;
    const bool whole =
        Phrase(entry.id).places().empty() && entry.id.find_first_of("\n,;:(") == std::string::npos;
    const auto blanks = static_cast<std::size_t>(std::count(entry.id.begin(), entry.id.end(), ' '));
    if (!whole || blanks < kWords || entry.id.front() == ' ' || entry.id.back() == ' ') continue;
    const auto text = std::string(bare(entry.id).text);
    const auto said = in_chinese(text);
    ++sentences;
    for (const std::string form :
         {"node 1: @", "@ (node 1)", "lift: @", "can0: @", "a.txt:3: @", "a.txt:3: node 1: @ [NODE=1]",
          "node 1, object 0x6041:0: @", "@; the drive is in fault"}) {
      const auto put = [&form](const std::string& what) {
        return form.substr(0, form.find('@')) + what + form.substr(form.find('@') + 1);
      };
      EXPECT_NE(in_chinese(put(text)).find(said), std::string::npos)
          << put(text) << " is " << in_chinese(put(text)) << " and has no " << said;
    }
  }
  EXPECT_GT(sentences, 500U);
}

TEST(Catalogue, OpensAndClosesBracketsInOneWay) {
  const auto c = small_catalogue();
  EXPECT_EQ(c.translated("fault (0x238)"), "故障（0x238）");
  EXPECT_EQ(c.translated("x (fault)"), "x（故障）");
  EXPECT_EQ(c.translated("x (0x238)"), "x (0x238)");
}

TEST(Catalogue, LeavesTheRoundOfABatchFileBehindAnError) {
  const auto c = small_catalogue();
  EXPECT_EQ(c.translated("the drive is in fault [NODE=1]"), "驱动器故障 [NODE=1]");
}

TEST(Catalogue, KnowsItsLiteralsWithBlanksAndPlaces) {
  const auto c = small_catalogue();
  EXPECT_EQ(c.literal(" (assumed)"), "（推定）");
  EXPECT_EQ(c.literal("node {}: {}"), "节点 {}：{}");
  EXPECT_EQ(c.literal("node 1: {}"), "");
}

TEST(Catalogue, LeavesQuotesBackticksAndNamesAsTheyAre) {
  const auto c = small_catalogue();
  EXPECT_EQ(c.translated("'fault' is not a command"), "'fault' 不是命令");
  EXPECT_EQ(c.translated("`fault; fault`"), "`fault; fault`");
  for (const auto* text : {"", ": ", "a.csv: my file", "--yes", "type of motor", "...", "0x10"})
    EXPECT_EQ(c.translated(text), text);
}

TEST(Catalogue, TakesATextApartWhereItsPartsAreKnown) {
  const auto c = small_catalogue();
  EXPECT_EQ(c.translated("fault; write 500ms or 2s."), "故障；写成 500ms 或 2s。");
  EXPECT_EQ(c.translated("fault (assumed), at most every 20 ms"), "故障（推定），最短间隔 20 ms");
  EXPECT_EQ(c.translated("fault\n  quick stop active  fault\n"), "故障\n  快速停机  故障\n");
}

TEST(Catalogue, DropsTheSOfAnEnglishPlural) {
  const auto c = small_catalogue();
  EXPECT_EQ(c.translated("3 times tried"), "尝试了 3 次");
  EXPECT_EQ(c.translated("1 time tried"), "尝试了 1 次");
}

TEST(Catalogue, TakesOnlyANumberWhereANumberStands) {
  const auto c = small_catalogue();
  EXPECT_EQ(c.translated("TPDO2 of node 3 is also sent with 0xyz"), "TPDO2 of node 3 is also sent with 0xyz");
}

/// What is tried grows with the square of a text at worst. The limit is far above what that takes under the
/// sanitizers on a busy machine, and far below what anything that grows faster would take.
TEST(Catalogue, EndsSoonWhateverItIsGiven) {
  const auto& c = chinese();
  const std::string pieces[] = {"node ", "the ", "fault", ": ", "; ", ", ",   "'",  "`", "(", ")",   " of ",
                                "12",    " - ",  "{}",    "\n", ". ", "中文", "  ", "a", "s", "is ", "drive"};
  std::mt19937 random(7);
  const auto begin = std::chrono::steady_clock::now();
  for (int round = 0; round < 100; ++round) {
    std::string text;
    for (std::size_t i = random() % 60; i > 0; --i) text += pieces[random() % std::size(pieces)];
    (void)c.translated(text);
  }
  std::string longest;
  while (longest.size() < 25'000) longest += pieces[random() % std::size(pieces)];
  std::erase(longest, '\n');
  (void)c.translated(longest);
  (void)c.translated(std::string(25'000, ':'));
  (void)c.translated(std::string(25'000, '('));
  (void)c.translated(std::string(25'000, '\''));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
}

TEST(ChineseValue, TranslatesHeadingsAndCellsButNoOwnWords) {
  Table table;
  table.columns = {{"node"}, {"state"}, {"device_name"}};
  table.rows.push_back({1, "fault", "fault"});
  const auto text = to_text(chinese_value(Value(std::move(table))));
  EXPECT_NE(text.find("节点"), std::string::npos) << text;
  EXPECT_NE(text.find("故障"), std::string::npos) << text;
  EXPECT_NE(text.find("fault"), std::string::npos) << text;
  EXPECT_EQ(to_text(chinese_value(Value(Record{{"energised", true}}))).find("yes"), std::string::npos);
}

TEST(ChineseMessages, CodesAreHexadecimalAsInEnglish) {
  auto refused = message("refused: {} (abort 0x{:08X})", "object does not exist in the object dictionary",
                         std::uint32_t{0x06020000});
  put_into_chinese(refused);
  EXPECT_NE(refused.text().find("0x06020000"), std::string::npos) << refused.text();
  EXPECT_EQ(refused.text().find("refused"), std::string::npos) << refused.text();
}

TEST(ChineseMessages, HaveNoPlural) {
  auto said = message("{}: {} error{}", as_it_is("x.eds"), 2, plural(2));
  put_into_chinese(said);
  EXPECT_EQ(said.text().find("error"), std::string::npos) << said.text();
  EXPECT_FALSE(said.text().ends_with('s')) << said.text();
}

TEST(ChineseMessages, KeepAUnitThatLooksLikeAPlural) {
  auto said = message("{}: {}", "5", std::string("s"));
  put_into_chinese(said);
  EXPECT_EQ(said.text(), "5：s");
}

}  // namespace
}  // namespace servoctl::report
