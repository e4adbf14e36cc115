// The Chinese that comes with the program.
#include "report/zh_po.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>

#include "report/catalogue.hpp"

namespace servoctl::report {
namespace {

/// What the test puts into a place: a number where one belongs, else a word that is in no catalogue.
std::vector<std::string> samples_of(const Phrase& phrase) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < phrase.places().size(); ++i) {
    const auto& place = phrase.places()[i];
    out.resize(std::max(out.size(), place.argument + 1));
    const bool beside = i > 0 && phrase.pieces()[i].empty();
    out[place.argument] =
        beside || (place.suffix && !place.number) ? "" : std::to_string(17 + place.argument);
  }
  return out;
}

TEST(ZhPo, IsReadAsAWhole) {
  const auto entries = parse_po(zh_po(), "zh.po");
  ASSERT_TRUE(entries) << entries.error().message.text();
  EXPECT_GT(entries->size(), 2000U);
}

/// What is put together with other texts is taken apart again: what stands at its ends does not count.
std::string core(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    bool skipped = false;
    for (const std::string_view mark : {"，", "；", "：", "。", "（", "）", "？", "、"})
      if (text.substr(i).starts_with(mark)) {
        i += mark.size() - 1;
        skipped = true;
        break;
      }
    if (!skipped && std::string_view(" ,;:.()?\n").find(text[i]) == std::string_view::npos) out += text[i];
  }
  return out;
}

TEST(ZhPo, EveryEntryIsFoundByTheTextsThatAreMadeWithIt) {
  const auto entries = parse_po(zh_po(), "zh.po");
  ASSERT_TRUE(entries);
  std::size_t wrong = 0;
  for (const auto& entry : *entries) {
    if (entry.text.empty()) continue;
    const Phrase id(entry.id);
    if (!id.places().empty() && (id.letters() < 3 || id.words().empty())) continue;
    const auto samples = samples_of(id);
    const auto text = id.with(samples);
    const auto wanted = Phrase(entry.text).with(samples);
    const auto said = in_chinese(text);
    if (core(said) == core(wanted)) continue;
    ++wrong;
    ADD_FAILURE() << "line " << entry.line << ": " << text << "\n  is      " << said << "\n  and not "
                  << wanted;
  }
  EXPECT_EQ(wrong, 0U);
}

/// What asks before something moves, is written or restarts, and what warns: a part left in English, or put
/// together from parts, may be understood wrongly.
TEST(ZhPo, AsksAndWarnsInWholeSentences) {
  const std::pair<std::string_view, std::string_view> kSaid[] = {
      {"node 1: THE FINAL STATE COULD NOT BE VERIFIED: SWITCH OFF THE SUPPLY (its watchdog is set to stop it 500 ms "
       "after the last message; that was not seen); the motion ended with: node 1, object 0x6041:0: no answer within 200 ms",
       "节点 1：无法确认最终状态：切断供电电源（其看门狗设为在最后一条报文 500 ms 之后使其停止；是否停止未能观察到）；运动以此结束：节点 1，对象 "
       "0x6041:0：200 ms 内无应答"},
      {"node 1: IT IS IN operation enabled (statusword 0x0237), NOT DE-ENERGISED: SWITCH OFF THE SUPPLY (nothing is known "
       "that stops it by itself); the motion ended with: node 1, object 0x6041:0: no answer within 200 ms",
       "节点 1：驱动器处于伺服运行（状态字 0x0237），未去使能：切断供电电源（不知道有什么能使其自行停止）；运动以此结束：节点 1，对象 "
       "0x6041:0：200 ms 内无应答"},
      {"node 1: it did not answer and was sent NMT \"enter pre-operational\": a stopped node does not answer",
       "节点 1：它无应答，已向其发送 NMT 命令“进入预操作”：已停止的节点不应答"},
      {"Change TPDO2 of node 1? Other users of it must be changed too.",
       "修改节点 1 的 TPDO2？使用它的其他设备也必须相应修改。"},
      {"Put back Pn0214 on node 1: 600 in place of 500?", "还原节点 1 的 Pn0214：以 600 代替 500？"},
      {"Over Modbus nothing tells whether it is the same drive. Put back, and keep at power-off, Fn_103 on lift: 0 "
       "in place of 7?",
       "经 Modbus 无从知道是否为同一台驱动器。还原并断电保存轴 lift 的 Fn_103：以 0 代替 7？"},
      {"Re-address node 3 (serial number 16) to node-ID 5? It is restarted (NMT reset node).",
       "更改地址：节点 3（序列号 16）改为节点 ID 5？驱动器将重启（NMT 复位节点）。"},
      {"node 4: this node-ID is taken: it answers", "节点 4：此节点 ID 已被占用：它有应答"},
      {"Send the 9 frames of a.log on can0 again: 6 heartbeats, 3 SDO messages? 3 of them can move a motor: 3 write "
       "of 0x6040:0.",
       "在 can0 上重新发送 a.log 的 9 帧：6 个心跳，3 个 SDO 报文？其中 3 帧可使电机运动：3 次写 0x6040:0。"},
      {"'x' is not a part of the settings: write one of communication, pdo, gain",
       "'x' 不是设置的一部分：写以下之一：communication, pdo, gain"},
      {"Reset the fault of node 1? The cause must be gone.", "复位节点 1 的故障？故障原因必须已经消除。"},
  };
  for (const auto& [english, said] : kSaid) EXPECT_EQ(in_chinese(english), said);
}

TEST(Phrase, HasNoBlankBetweenChineseAndChinese) {
  EXPECT_EQ(Phrase("复位 {} 的故障").with({"所有节点"}), "复位所有节点的故障");
  EXPECT_EQ(Phrase("复位 {} 的故障").with({"节点 1"}), "复位节点 1 的故障");
  EXPECT_EQ(Phrase("复位 {} 的故障").with({"lift"}), "复位 lift 的故障");
  EXPECT_EQ(Phrase("{} of {}").with({"one", "two"}), "one of two");
}

}  // namespace
}  // namespace servoctl::report
