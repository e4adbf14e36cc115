#include "trial/report_words.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

namespace servoctl::trial {
namespace {

using Pair = std::pair<std::string_view, std::string_view>;

/// Headings of the commands of which a report is made.
constexpr std::array kWords{
    Pair{"yes", "是"},
    Pair{"no", "否"},
    Pair{"node", "节点"},
    Pair{"name", "名称"},
    Pair{"object", "对象"},
    Pair{"value", "值"},
    Pair{"unit", "单位"},
    Pair{"note", "备注"},
    Pair{"ended without an error", "无错误结束"},
    Pair{"mode", "运行模式"},
    Pair{"modes", "支持的模式"},
    Pair{"fault", "故障"},
    Pair{"device type", "设备类型"},
    Pair{"which is", "设备类别"},
    Pair{"assumed", "推定"},
    Pair{"contradicted", "手册前后矛盾"},
    Pair{"device name", "设备名称"},
    Pair{"hardware", "硬件版本"},
    Pair{"software", "软件版本"},
    Pair{"vendor", "厂商"},
    Pair{"product", "产品代码"},
    Pair{"revision", "修订号"},
    Pair{"serial", "序列号"},
    Pair{"family", "驱动器系列"},
    Pair{"error register", "错误寄存器"},
    Pair{"error register 1001h", "错误寄存器 1001h"},
    Pair{"error code 603Fh", "错误代码 603Fh"},
    Pair{"history 1003h", "故障历史 1003h"},
    Pair{"history 1003h, newest first", "故障历史 1003h（最新在前）"},
    Pair{"emergencies heard", "收到的紧急报文"},
    Pair{"what it may be", "可能的原因"},
    Pair{"number", "序号"},
    Pair{"code", "代码"},
    Pair{"extra", "附加代码"},
    Pair{"panel", "面板显示"},
    Pair{"kind", "类型"},
    Pair{"resettable", "可复位"},
    Pair{"check", "检查"},
    Pair{"meaning", "含义"},
    Pair{"heartbeat (ms)", "心跳 (ms)"},
    Pair{"nmt", "NMT 状态"},
    Pair{"NMT state", "NMT 状态"},
    Pair{"NMT", "NMT 状态"},
    Pair{"AL", "AL 状态"},
    Pair{"al_state", "AL 状态"},
    Pair{"AL state", "AL 状态"},
    Pair{"process data", "过程数据"},
    Pair{"drive state", "驱动器状态"},
    Pair{"state", "驱动器状态"},
    Pair{"energised", "已使能"},
    Pair{"statusword", "状态字"},
    Pair{"statusword bits", "状态字各位"},
    Pair{"compared", "已比较"},
    Pair{"different", "不同"},
    Pair{"differences", "差异"},
    Pair{"factory", "出厂值"},
    Pair{"test", "测试"},
    Pair{"verdict", "结论"},
    Pair{"criteria", "测试项"},
    Pair{"criterion", "测试项"},
    Pair{"figure", "测量值"},
    Pair{"limit", "限值"},
    Pair{"samples", "曲线"},
    Pair{"reads", "读取次数"},
    Pair{"min", "最小"},
    Pair{"median", "中位数"},
    Pair{"max", "最大"},
    Pair{"name_zh", "中文名称"},
    Pair{"station", "站地址"},
    Pair{"alias", "别名"},
    Pair{"ports", "端口"},
    Pair{"alarm", "报警"},
    Pair{"inputs on", "接通的输入"},
    Pair{"outputs on", "接通的输出"},
    Pair{"no samples", "无采样数据"},
};

constexpr std::array kTests{
    Pair{"comm", "通信测试"},
    Pair{"io", "输入测试"},
    Pair{"jog", "点动测试"},
    Pair{"home", "回零测试"},
};

std::string chinese_of(std::span<const Pair> words, std::string_view word) {
  const auto found =
      std::find_if(words.begin(), words.end(), [&](const Pair& pair) { return pair.first == word; });
  return std::string(found == words.end() ? std::string_view() : found->second);
}

}  // namespace

std::string heading_zh(std::string_view heading) {
  // `node 1`: the column of one drive in a comparison.
  if (heading.starts_with("node ")) return "节点 " + std::string(heading.substr(5));
  auto chinese = chinese_of(kWords, heading);
  return chinese.empty() ? std::string(heading) : chinese;
}

std::string test_zh(std::string_view test) { return chinese_of(kTests, test); }

}  // namespace servoctl::trial
