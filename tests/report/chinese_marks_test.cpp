#include "report/chinese_marks.hpp"

#include <gtest/gtest.h>

#include "base/text.hpp"
#include "report/catalogue.hpp"
#include "report/zh_po.hpp"

namespace servoctl::report {
namespace {

TEST(ChineseMarks, AreWideBesideChineseAndStayBetweenFiguresAndNames) {
  EXPECT_EQ(chinese_marks("主回路电接通, 远程控制"), "主回路电接通，远程控制");
  EXPECT_EQ(chinese_marks("DI, 输入功能: CW 输入;"), "DI，输入功能：CW 输入；");
  EXPECT_EQ(chinese_marks("系列: gsd600? 或 ts?"), "系列：gsd600? 或 ts?");
  EXPECT_EQ(chinese_marks("组: canopen、电机 或 监视"), "组：canopen、电机或监视");
  EXPECT_EQ(chinese_marks("端子 或 canopen, jog 和 监视"), "端子 或 canopen, jog 和 监视");
  EXPECT_EQ(chinese_marks("节点 1 的 0x6041:0, 0x6040:0 为 1, 2"), "节点 1 的 0x6041:0, 0x6040:0 为 1, 2");
  EXPECT_EQ(chinese_marks("a.txt:3: 节点"), "a.txt:3：节点");
  EXPECT_EQ(chinese_marks("a.txt:3: Pn0214 增益"), "a.txt:3：Pn0214 增益");
  for (const auto* text : {"", "fault, ready (0x40): yes", "状态", "1017h: 00h 心跳", "1.5 倍"})
    EXPECT_EQ(chinese_marks(text), text);
}

TEST(ChineseMarks, BracketsAreBothWideOrNeither) {
  EXPECT_EQ(chinese_marks("轮廓位置模式 (pp)"), "轮廓位置模式（pp）");
  EXPECT_EQ(chinese_marks("LSP (正转行程末端)"), "LSP（正转行程末端）");
  EXPECT_EQ(chinese_marks("（手册 (215 行)）"), "（手册（215 行））");
  EXPECT_EQ(chinese_marks("需要重启（7)"), "需要重启（7）");
  EXPECT_EQ(chinese_marks("0x181 ($NODEID+0x180)，无效"), "0x181 ($NODEID+0x180)，无效");
  EXPECT_EQ(chinese_marks("状态) 和 (没有"), "状态) 和 (没有");
}

TEST(ChineseMarks, StayInQuotesAndBackticks) {
  for (const auto* text : {"`状态, (故障)`", "'状态, 故障' 不是命令", "其名称为 \"状态: 故障\"", "“a, 状态”"})
    EXPECT_EQ(chinese_marks(text), text);
}

TEST(ChineseMarks, TakeAsMuchRoomAsAMarkAndItsBlank) {
  for (const auto* text : {"状态, 故障", "值: 电机", "状态? 电机"})
    EXPECT_EQ(display_width(chinese_marks(text)), display_width(text)) << text;
}

/// The sentences themselves: in one that is Chinese no mark is of the other kind.
TEST(ChineseMarks, AreThoseOfTheWholeCatalogue) {
  const auto entries = parse_po(zh_po(), "zh.po");
  ASSERT_TRUE(entries);
  for (const auto& entry : *entries) {
    EXPECT_EQ(chinese_marks(entry.text), entry.text) << "line " << entry.line;
  }
}

}  // namespace
}  // namespace servoctl::report
