#include "trial/report_phrases.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "drive/cia402.hpp"
#include "trial/phrase_table.hpp"
#include "trial/report_words.hpp"

namespace servoctl::trial {
namespace {

using Pair = PhrasePair;

/// Texts around others: a `*` stands for one, a `#` for one that begins with a digit. The first that fits is
/// taken. In Chinese `*2` is the second of them, where the order is another.
constexpr std::array kFrames{
    Pair{"there is no slave at this position: # is on the ring", "此位置没有从站：环上共 * 个"},
    Pair{"there is no slave at this position: # are on the ring", "此位置没有从站：环上共 * 个"},
    Pair{"# slaves are on the ring: those behind position # have no node number",
         "环上有 * 个从站：第 * 个之后的没有节点号"},
    Pair{"port #: *", "端口 *：*"},
    Pair{"# bad frames", "* 个坏帧"},
    Pair{"# bad frame", "* 个坏帧"},
    Pair{"# bad symbols", "* 个坏符号"},
    Pair{"# bad symbol", "* 个坏符号"},
    Pair{"# lost links", "* 次断链"},
    Pair{"# lost link", "* 次断链"},
    Pair{"SII: *", "SII：*"},
    Pair{"node #, object #: *", "节点 *，对象 *：*"},
    Pair{"node # has no PDO parameters that can be read", "节点 * 没有可读的 PDO 参数"},
    Pair{"node # has no statusword: it is not a CiA 402 drive", "节点 * 无状态字：不是 CiA 402 驱动器"},
    Pair{"*: the manual does not state it", "*：手册未说明"},
    Pair{"*: the manual also states another value", "*：手册另有不同的值"},
    Pair{"* (line #)", "*（第 * 行）"},
    Pair{"* (lines #)", "*（第 * 行）"},
    Pair{"no answer to the block transfer request within #", "* 内未应答块传输请求"},
    Pair{"node #: *", "节点 *：*"},
    Pair{"one of # alarms: *", "* 种报警之一：*"},
    Pair{"refused: * (abort *)", "被拒绝：*（中止码 *）"},
    Pair{"no answer within #", "* 内无应答"},
    Pair{"# values of factory have no Modbus register: they are not compared",
         "* 个出厂值没有 Modbus 寄存器：未比较"},
    Pair{"*, as you said", "*（按指定）"},
    Pair{"*, as you said: registers do not say what a device is", "*（按指定：寄存器不说明设备类型）"},
    Pair{"*  (a guess, not proof: use -d FAMILY)", "*（推测，未经证实）"},
    Pair{"conflict: *", "冲突：*"},
    Pair{"from the factory: *", "出厂：*"},
    Pair{"# is reserved for *", "* 保留给 *"},
    Pair{"* of node # is also sent with #", "节点 *2 的 *1 也以 *3 发送"},
    Pair{"* of node # receives it", "节点 *2 的 *1 接收它"},
    Pair{"* of node # also receives #", "节点 *2 的 *1 也接收 *3"},
    Pair{"*, assigned", "*，已分配"},
    Pair{"*, from SYNC # on", "*，从第 * 个 SYNC 起"},
    Pair{"*, event timer # ms", "*，事件定时器 * ms"},
    Pair{"*, at most every # ms", "*，最短间隔 * ms"},
    Pair{"# not valid, *", "*，无效，*"},
    Pair{"# valid, *", "*，有效，*"},
    Pair{"# not valid", "*，无效"},
    Pair{"# valid", "*，有效"},
    Pair{"* (type #)", "*（类型 *）"},
    Pair{"type #", "类型 *"},
    Pair{"event timer # ms", "事件定时器 * ms"},
    Pair{"inhibit time # ms", "禁止时间 * ms"},
    Pair{"SYNC start #", "SYNC 起始值 *"},
    Pair{"at every # SYNC", "每 * 个 SYNC 发送一次"},
    Pair{"no COB-ID, mapping #", "无 COB-ID，映射 *"},
    Pair{"mapping #", "映射 *"},
    Pair{"# of 64 bits: *", "64 位中的 * 位：*"},
    Pair{"# bytes: *", "* 字节：*"},
    Pair{"CiA 402, * and *", "CiA 402，*和*"},
    Pair{"CiA 402, *", "CiA 402，*"},
    Pair{"device profile #", "设备子协议 *"},
    Pair{"# cycles; frames lost: #, outputs not taken: #, inputs not given: #",
         "* 个周期；丢帧：*，输出未接收：*，输入未提供：*"},
    Pair{"* after a quick stop, verified (statusword #)", "*（快速停机后），已确认（状态字 *）"},
    Pair{"*, verified (statusword #)", "*，已确认（状态字 *）"},
    Pair{"forward: *", "正转：*"},
    Pair{"backward: *", "反转：*"},
    Pair{"in # reads", "共读取 * 次"},
    Pair{"in # reads, then given up", "共读取 * 次，之后放弃"},
    Pair{"changed # time", "变化 * 次"},
    Pair{"changed # times", "变化 * 次"},
    Pair{"bit #", "位 *"},
    Pair{"*, error 0x*", "*，错误 0x*"},
    Pair{"0x* *", "0x* *"},
    Pair{"*? or *?", "*? 或 *?"},
    Pair{"*, *", "*, *"},
};

std::string state_zh(std::string_view text) {
  using drive::DriveState;
  for (const auto state :
       {DriveState::not_ready_to_switch_on, DriveState::switch_on_disabled, DriveState::ready_to_switch_on,
        DriveState::switched_on, DriveState::operation_enabled, DriveState::quick_stop_active,
        DriveState::fault_reaction_active, DriveState::fault})
    if (drive::name(state) == text) return std::string(drive::name_zh(state));
  return {};
}

constexpr std::string_view kStars = "*#";

/// What stands at the stars of `frame`; empty when the text is none of that kind.
std::vector<std::string_view> parts_of(std::string_view text, std::string_view frame) {
  std::vector<std::string_view> out;
  for (;;) {
    const auto star = frame.find_first_of(kStars);
    const auto before = frame.substr(0, star);
    if (!text.starts_with(before)) return {};
    text.remove_prefix(before.size());
    if (star == std::string_view::npos) return text.empty() ? out : std::vector<std::string_view>();
    const bool is_number = frame[star] == '#';
    frame.remove_prefix(star + 1);
    const auto next = frame.substr(0, frame.find_first_of(kStars));
    const bool is_last = next.size() == frame.size();
    if (is_last && !text.ends_with(next)) return {};
    const auto end = is_last ? text.size() - next.size() : text.find(next);
    if (end == std::string_view::npos || end == 0) return {};
    if (is_number && (text[0] < '0' || text[0] > '9')) return {};
    out.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
}

std::string framed(std::string_view frame, const std::vector<std::string_view>& parts) {
  std::string out;
  std::size_t next = 0;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    if (frame[i] != '*') {
      out += frame[i];
      continue;
    }
    const bool has_place = i + 1 < frame.size() && frame[i + 1] >= '1' && frame[i + 1] <= '9';
    const auto part = has_place ? static_cast<std::size_t>(frame[++i] - '1') : next++;
    out += phrase_zh(parts[part]);
  }
  return out;
}

/// What a drive says of itself, and for programs.
bool is_own_word(std::string_view key) {
  return key == "device_name" || key == "hardware_version" || key == "software_version" || key == "panel" ||
         key == "object" || key == "time" || key == "tool" || key == "customer" || key == "machine" ||
         key == "operator" || key == "bus";
}

}  // namespace

std::string phrase_zh(std::string_view text) {
  const auto phrases = whole_phrases();
  const auto found =
      std::find_if(phrases.begin(), phrases.end(), [&](const Pair& pair) { return pair.first == text; });
  if (found != phrases.end()) return std::string(found->second);
  if (auto state = state_zh(text); !state.empty()) return state;
  // There `node 1` heads a column.
  if (auto word = heading_zh(text); word != text && !text.starts_with("node ")) return word;
  for (const auto& [frame, chinese] : kFrames)
    if (const auto parts = parts_of(text, frame); !parts.empty()) return framed(chinese, parts);
  return std::string(text);
}

report::Value in_chinese(report::Value value) {
  if (auto* text = std::get_if<std::string>(&value.data())) return phrase_zh(*text);
  if (auto* list = std::get_if<report::List>(&value.data()))
    for (auto& element : *list) element = in_chinese(std::move(element));
  if (auto* record = std::get_if<report::Record>(&value.data()))
    for (auto& field : *record)
      if (!is_own_word(field.key)) field.value = in_chinese(std::move(field.value));
  if (auto* table = std::get_if<report::Table>(&value.data()))
    for (auto& row : table->rows)
      for (std::size_t i = 0; i < row.size(); ++i)
        if (!is_own_word(table->columns[i].key)) row[i] = in_chinese(std::move(row[i]));
  if (auto* plot = std::get_if<report::Plot>(&value.data()))
    for (auto& series : plot->series) series.name = phrase_zh(series.name);
  return value;
}

}  // namespace servoctl::trial
