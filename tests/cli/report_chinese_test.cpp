// With --lang zh nothing in a report is left in English but names and signs.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "cli/line_runner.hpp"
#include "recording_console.hpp"
#include "report/catalogue.hpp"
#include "report/chinese_value.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;

/// What stays: identifiers of the standards, units, names of makers and families, and what the test itself
/// wrote.
const std::regex kNames(
    "AL|CAN|CANopen|COB|CiA|EtherCAT|ID|INIT|IO|Modbus|NMT|NODEID|OP|PDO|PRE|RPDO|SAFE|SYNC|TPDO|"
    "comm|csp|cst|csv|deg|hm|ip|jog|ms|pp|pt|pv|servoctl|vl|ACME|"
    "DM|GSD|INVT|SINSEGYE|SV|DA|DSX|Syntron|TS|VMMORE|da|dm|gsd|sv|ts|sim|Dn_|Pn|Fn_|PA|ERR_oc");

class ReportChinese : public testing::TestWithParam<const char*> {
 protected:
  ReportChinese() { fs::create_directories(dir_); }
  ~ReportChinese() override { fs::remove_all(dir_); }

  std::string report(const std::string& family, const std::string& bus, const std::string& options,
                     int exit) {
    Shell::Options shell_options;
    shell_options.drive_folders = {fs::path(source_dir()) / "eds"};
    shell_options.clock = sim::SimBus::Clock::virtual_time;
    shell_options.defaults.bus = bus;
    shell_options.defaults.drive = family;
    Shell shell(console, std::move(shell_options));
    const auto path = dir_ / "report.html";
    EXPECT_EQ(LineRunner(shell).run("report " + path.string() + " --lang zh " + options), exit)
        << console.err_text;
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
  }

  std::string tests_in_english() const {
    std::ofstream(dir_ / "tests.json")
        << R"x({"servoctl":1,"command":"test jog","ok":true,"bus":null,"result":[
      {"test":"jog","node":1,"passed":true,"seconds":4,"criteria":[
        {"id":"completed","name":"motion completed","verdict":"passed","figure":"yes","relation":"=","limit":"yes",
         "unit":null,"note":null},
        {"id":"left_without_power","name":"left de-energised","verdict":"passed","figure":"yes","relation":"=",
         "limit":"yes","unit":null,"note":"switch on disabled, verified (statusword 0x0650)"},
        {"id":"stop_backward","name":"backward: time to standstill","verdict":"skipped","figure":null,
         "relation":null,"limit":null,"unit":null,"note":"not reported by the drive"}],
       "samples":[{"name":"following_error","unit":"deg","seconds":[0,1],"values":[0,1]},
                  {"name":"torque","unit":"%","seconds":[],"values":[]}]}],"notices":[]})x";
    return " --tests " + (dir_ / "tests.json").string();
  }

  /// Words of Latin letters in the text of a page.
  static std::string english_in(std::string html) {
    html = html.substr(html.find("<body>"));
    html = std::regex_replace(html, std::regex("<[^>]*>"), "\n");
    html = std::regex_replace(
        html,
        std::regex(
            "(coe:)?sim:[^\n]*|`[a-z ]+`|servoctl [^\n]*|&[a-z#0-9]+;|\\b0x[0-9A-F]+\\b|\\b[0-9A-F]{4}h\\b|\\b[0-9]{4}-[0-9TZ:-]+"),
        " ");
    std::string out;
    const std::regex word("[A-Za-z_]{2,}");
    std::istringstream lines(html);
    for (std::string line; std::getline(lines, line);)
      for (std::sregex_iterator i(line.begin(), line.end(), word), end; i != end; ++i)
        if (!std::regex_match(i->str(), kNames)) {
          out += i->str() + " in: " + line + "\n";
          break;
        }
    return out;
  }

  RecordingConsole console;
  fs::path dir_ = fs::temp_directory_path() / ("servoctl-chinese-" + std::to_string(::getpid()));
};

TEST_P(ReportChinese, LeavesNoEnglishWordInTheReportOf) {
  const std::string family = GetParam();
  const auto bus = (family == "sv2" ? "coe:sim:" : "sim:") + family + "@1";
  const auto html = report(family, bus, "-n 1 --customer ACME" + tests_in_english(), 0);
  EXPECT_EQ(english_in(html), "");
  for (const auto* word :
       {"客户", "签字", "点动测试（jog）", "反转：停止时间", "跟随误差（deg）", "转矩（%）：无采样数据"})
    EXPECT_NE(html.find(word), std::string::npos) << word;
}

TEST_P(ReportChinese, LeavesNoEnglishWordInTheReportOfOneInFault) {
  const std::string family = GetParam();
  const std::string fault = family == "ts" ? "ERR_oc" : family == "sv2" ? "0x2310" : "0x3210";
  const auto bus = (family == "sv2" ? "coe:sim:" : "sim:") + family + "@1?fault=" + fault + "@1ms";
  EXPECT_EQ(english_in(report(family, bus, "-n 1", 0)), "");
}

TEST_P(ReportChinese, LeavesNoEnglishWordWhereADriveDoesNotAnswer) {
  const std::string family = GetParam();
  const auto bus = (family == "sv2" ? "coe:sim:" : "sim:") + family + "@1";
  const auto html = report(family, bus, "-n 1,9 --timeout 50ms", 4);
  EXPECT_EQ(english_in(html), "");
}

INSTANTIATE_TEST_SUITE_P(Families, ReportChinese, testing::Values("gsd600", "dm", "sv2", "da200", "ts"),
                         [](const auto& about) { return std::string(about.param); });

TEST(ReportPhrases, PutWordsAroundNamesAndNumbersIntoChinese) {
  using report::in_chinese;
  EXPECT_EQ(in_chinese("node 3, object 0x1003:0: refused: sub-index does not exist (abort 0x06090011)"),
            "节点 3，对象 0x1003:0：被拒绝：子索引不存在（中止码 0x06090011）");
  EXPECT_EQ(in_chinese("conflict: TPDO2 of node 3 is also sent with 0x281"),
            "冲突：节点 3 的 TPDO2 也以 0x281 发送");
  EXPECT_EQ(
      in_chinese(
          "0x181 ($NODEID+0x180) not valid, by event (type 255), at most every 2.5 ms, event timer 10 ms, "
          "from SYNC 3 on, assigned"),
      "0x181 ($NODEID+0x180)，无效，事件触发（类型 255），最短间隔 2.5 ms，事件计时器 10 ms，从第 3 个 SYNC 起，已分配");
  EXPECT_EQ(in_chinese("0x11 generic, communication"), "0x11 一般错误，通信");
  EXPECT_EQ(in_chinese("quick stop active after a quick stop, verified (statusword 0x0617)"),
            "快速停机（快速停机后），已确认（状态字 0x0617）");
}

TEST(ReportPhrases, LeaveOtherTextAsItIs) {
  using report::in_chinese;
  for (const auto* text : {"", "*", "#", "A drive of ours", "type of motor"})
    EXPECT_EQ(in_chinese(text), text);
  report::Value said(
      report::Record{{"device_name", "none"}, {"software_version", "empty"}, {"fault", "none"}});
  EXPECT_EQ(report::to_json(report::chinese_value(said)),
            R"({"device_name":"none","software_version":"empty","fault":"无"})");
}

}  // namespace
}  // namespace servoctl::cli
