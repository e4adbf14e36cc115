#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>

#include "base/file.hpp"
#include "base/text.hpp"
#include "command/man_page.hpp"
#include "command/prompt_words.hpp"
#include "command/registry.hpp"
#include "command/roff.hpp"
#include "session/open_bus.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::commands {
using namespace command;
namespace {

const std::string& page() {
  static const auto text = man_page("1.2.3", "2026-01-02");
  return text;
}

bool page_has(const std::string& line) { return ("\n" + page()).find("\n" + line) != std::string::npos; }

TEST(ManPage, HasTheSectionsThatAReaderLooksFor) {
  std::string sections;
  for (const auto line : split(page(), '\n'))
    if (line.starts_with(".SH ")) sections += std::string(line.substr(4)) + "\n";
  EXPECT_EQ(
      sections,
      "NAME\nSYNOPSIS\nDESCRIPTION\nGLOBAL OPTIONS\nCOMMANDS\nWORDS OF THE PROMPT\nBUSES\nEXIT STATUS\nENVIRONMENT\nFILES\n"
      "EXAMPLES\nSEE ALSO\n");
  EXPECT_TRUE(page_has(".TH SERVOCTL 1 \"2026-01-02\" \"servoctl 1.2.3\""));
}

TEST(ManPage, KnowsEveryCommandAndOption) {
  for (const auto* entry : registry()) {
    EXPECT_TRUE(page_has(".SS \\fB" + roff_literal(entry->path) + "\\fR")) << entry->path;
    for (const auto& parameter : entry->parameters)
      if (parameter.name.starts_with("-")) {
        EXPECT_NE(page().find("\\fB" + roff_literal(parameter.name) + "\\fR"), std::string::npos)
            << entry->path << " " << parameter.name;
      }
  }
  for (const auto& word : prompt_words())
    EXPECT_TRUE(page_has(".SS \\fB" + roff_literal(word.name) + "\\fR"));
  for (const auto& option : global_options())
    EXPECT_NE(page().find("\\fB" + roff_literal(option.name) + "\\fR"), std::string::npos) << option.name;
}

TEST(ManPage, ShowsEveryExampleAsItIsTypedInAShell) {
  for (const auto* entry : registry())
    for (const auto& example : entry->examples)
      EXPECT_TRUE(page_has(".TP\n\\fBservoctl " + roff_literal(example.line) + "\\fR\n")) << example.line;
  for (const auto& word : prompt_words())
    for (const auto& example : word.examples)
      EXPECT_TRUE(page_has(".TP\n\\fB" + roff_literal(example.line) + "\\fR\n")) << example.line;
}

TEST(ManPage, IsAsciiWithoutALineThatIsTakenForARequest) {
  const std::set<std::string_view> requests{"\\\"", "TH", "SH", "SS", "TP", "PP", "nh", "ad", "ds", "br"};
  for (const auto line : split(page(), '\n')) {
    EXPECT_FALSE(line.starts_with('\'')) << line;
    EXPECT_FALSE(line.ends_with(' ')) << line;
    if (line.starts_with('.')) {
      EXPECT_EQ(requests.count(line.substr(1, line.find(' ') - 1)), 1U) << line;
    }
    for (const char c : line) EXPECT_TRUE(c >= ' ' && c < 0x7F) << line;
  }
}

TEST(ManPage, IsWholeInChinese) {
  const auto chinese = man_page("1.2.3", "2026-01-02", true);
  std::string sections;
  for (const auto line : split(chinese, '\n'))
    if (line.starts_with(".SH ")) sections += std::string(line.substr(4)) + " ";
  EXPECT_EQ(sections, "名称 概要 描述 全局选项 命令 交互模式的词 总线 退出状态 环境变量 文件 示例 另请参阅 ");
  for (const std::string_view request : {"\n.SS ", "\n.TP\n", "\n.PP\n"}) {
    const auto count = [&](const std::string& text) {
      std::size_t found = 0;
      for (auto at = text.find(request); at != std::string::npos; at = text.find(request, at + 1)) ++found;
      return found;
    };
    EXPECT_GT(count(chinese), 100U) << request;
    EXPECT_EQ(count(chinese), count(page())) << request;
  }
  const std::regex english("^[^\\\\.]*[a-z]{2,} [a-z]{2,}");
  for (const auto line : split(chinese, '\n'))
    EXPECT_FALSE(line.find("\\[u") == std::string_view::npos && std::regex_search(std::string(line), english))
        << line;
}

TEST(ManPage, NamesBusesAsTheyAreOpened) {
  std::set<std::string_view> schemes;
  for (const auto& bus : manual_buses()) {
    EXPECT_TRUE(session::check_url(bus.name)) << bus.name;
    if (bus.name.find(':') != std::string_view::npos) schemes.insert(bus.name.substr(0, bus.name.find(':')));
  }
  for (const std::string_view scheme :
       {"slcan", "socketcand", "gateway", "local", "sim", "replay", "coe", "modbus"})
    EXPECT_EQ(schemes.count(scheme), 1U) << scheme;
}

TEST(ManPage, NamesEveryVariableThatTheProgramReads) {
  std::set<std::string> read;
  const std::regex call(R"re((?:getenv|variable)\("([A-Z_]+)"\))re");
  for (const auto* folder : {"/src", "/commands"})
    for (const auto& entry : std::filesystem::recursive_directory_iterator(source_dir() + folder)) {
      if (entry.path().extension() != ".cpp") continue;
      const auto text = read_file(entry.path()).value();
      for (std::sregex_iterator at(text.begin(), text.end(), call), end; at != end; ++at)
        read.insert((*at)[1]);
    }
  std::set<std::string> told;
  for (const auto& variable : manual_environment()) told.emplace(variable.name);
  EXPECT_EQ(told, read);
}

TEST(Roff, KeepsWhatIsTypedAndHyphenatesProse) {
  EXPECT_EQ(roff_literal("--all-bitrates"), "\\-\\-all\\-bitrates");
  EXPECT_EQ(roff_literal(".pcap"), "\\&.pcap");
  EXPECT_EQ(roff_literal("a\\b'c\"d`e^f~g"), "a\\eb\\(aqc\\(dqd\\(gae\\(haf\\(tig");
  EXPECT_EQ(roff_literal("ID…"), "ID...");
  EXPECT_EQ(roff_literal("…"), "\\&...");
  EXPECT_EQ(roff_literal("刚\xFF"), "\\[u521A]\\[uFFFD]");
  EXPECT_EQ(roff_text("The node-ID of (--node) is 5-8."), "The node-ID of (\\-\\-node) is 5\\-8.\n");
  EXPECT_EQ(roff_text("Read `a-b` now. Then more."), "Read \\fBa\\-b\\fR now.\nThen more.\n");
  EXPECT_EQ(roff_text("An open ` stays"), "An open \\(ga stays\n");
  EXPECT_EQ(roff_text(".eds\n'x'"), "\\&.eds\n\\(aqx\\(aq\n");
  EXPECT_EQ(roff_text(""), "");
  EXPECT_EQ(roff_text("用 `a b` 读，写。"),
            "\\[u7528] \\fBa b\\fR \\[u8BFB]\\[uFF0C]\\:\\[u5199]\\[u3002]\n");
}

TEST(Roff, GoesOnInTheNextLineOfTheSourceWithinChinese) {
  std::string chinese;
  for (int i = 0; i < 40; ++i) chinese += "中";
  const auto text = roff_text("a " + chinese + ".b");
  std::string joined;
  for (const auto line : split(text, '\n')) {
    EXPECT_LE(line.size(), 80U) << line;
    joined += line.ends_with('\\') ? line.substr(0, line.size() - 1) : line;
  }
  std::string whole;
  for (int i = 0; i < 40; ++i) whole += (i > 0 ? "\\:" : "") + std::string("\\[u4E2D]");
  EXPECT_EQ(joined, "a " + whole + ".b");  // A full stop begins no line.
}

TEST(Roff, BreaksLongLinesAtSpacesOnly) {
  const auto text = roff_text("word . " + std::string(70, 'x') + " .word " + std::string(200, 'y') + " .");
  for (const auto line : split(text, '\n')) EXPECT_FALSE(line.starts_with('.')) << line;
  EXPECT_NE(text.find("\n" + std::string(200, 'y') + "\n\\&.\n"), std::string::npos);
}

}  // namespace
}  // namespace servoctl::commands
