#include "base/folded.hpp"

#include <gtest/gtest.h>

#include "base/text.hpp"

namespace servoctl {
namespace {

using FoldedLines = std::vector<std::string>;

TEST(Folded, MakesCaseFullWidthFormsAndBlanksOne) {
  EXPECT_EQ(folded("  CN3\tPin\n 7 "), "cn3 pin 7");
  EXPECT_EQ(folded("ＣＮ３：（ＣＡＮ）　７"), "cn3:(can) 7");
  EXPECT_EQ(folded("回零方式，7"), "回零方式,7");
  EXPECT_EQ(folded("。"), "。");
  EXPECT_EQ(folded(""), "");
  EXPECT_EQ(folded("a\x9B b"), "a\x9B b");
}

TEST(BrokenLines, EndAtBlanksAndNeverPastTheWidth) {
  EXPECT_EQ(broken_lines("one two three", 7), (FoldedLines{"one two", "three"}));
  EXPECT_EQ(broken_lines("one two three", 80), (FoldedLines{"one two three"}));
  EXPECT_EQ(broken_lines("unbreakable", 4), (FoldedLines{"unbreakable"}));
  EXPECT_EQ(broken_lines("", 4), (FoldedLines{""}));
  EXPECT_EQ(broken_lines("a  b\nc", 80), (FoldedLines{"a b c"}));
}

TEST(BrokenLines, EndBetweenWideCharactersButNotBeforeWhatCloses) {
  EXPECT_EQ(broken_lines("搜索原点开关", 6), (FoldedLines{"搜索原", "点开关"}));
  EXPECT_EQ(broken_lines("搜索原点。开关", 8), (FoldedLines{"搜索原", "点。开关"}));
  EXPECT_EQ(broken_lines("信号（原点）", 6), (FoldedLines{"信号", "（原", "点）"}));
  EXPECT_EQ(broken_lines("设 Pn0603 = 0 并重启", 12), (FoldedLines{"设 Pn0603 =", "0 并重启"}));
  for (const auto& line :
       broken_lines("轴先正向运动 (起始时开关有效则先反向运动)，若先碰到正向限位则折返。", 20))
    EXPECT_LE(display_width(line), 20U) << line;
}

}  // namespace
}  // namespace servoctl
