// With --lang zh people read Chinese; JSON is the same in all languages.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "base/text.hpp"
#include "command/help_text.hpp"
#include "command/prompt_words.hpp"
#include "command/registry.hpp"
#include "golden_cases.hpp"

namespace servoctl::cli {
namespace {

/// Everything in English that is no text of the program: names and remarks in drive data, files of
/// tests, command lines.
const std::string& english_data() {
  static const std::string text = [] {
    std::string out;
    for (const auto* folder : {"eds", "tests/cli/data", "tests/cli/golden/cases.txt"}) {
      const auto read = [&](const std::filesystem::path& path) {
        std::ostringstream content;
        content << std::ifstream(path).rdbuf();
        out += content.str() + "\n";
      };
      const auto path = golden_source() / folder;
      if (!std::filesystem::is_directory(path)) {
        read(path);
        continue;
      }
      for (const auto& entry : std::filesystem::recursive_directory_iterator(path))
        if (entry.is_regular_file()) read(entry.path());
    }
    for (const auto* command : command::registry()) {
      out += "servoctl " + std::string(command->path) + "\n";
      for (const auto& example : command->examples) out += std::string(example.line) + "\n";
    }
    return out;
  }();
  return text;
}

/// Three words of English one behind the other, outside quotes, backticks and what comes from files.
std::string english_in(std::string line) {
  static const std::regex kept("`[^`]*`|'[^']*'|\"[^\"]*\"");
  static const std::regex sentence("(^|[^A-Za-z./_-])([a-z]{2,} [a-z]{2,} [a-z]{2,})(?![a-z_./-])");
  line = std::regex_replace(line, kept, "#");
  std::smatch found;
  while (std::regex_search(line, found, sentence)) {
    if (english_data().find(found[2].str()) == std::string::npos) return found[2].str();
    line = found[2].str().substr(found[2].str().find(' ') + 1) + found.suffix().str();
  }
  return {};
}

/// Lines that stay: the reason stands behind the last column of the file.
std::vector<std::string> exceptions() {
  std::vector<std::string> out;
  std::ifstream file(golden_source() / "tests/cli/chinese_exceptions.txt");
  for (std::string line; std::getline(file, line);)
    if (!line.empty() && line.front() != '#') out.push_back(line.substr(0, line.find("  #")));
  return out;
}

std::set<std::string> english_lines(const std::string& said) {
  static const auto excepted = exceptions();
  std::set<std::string> out;
  std::istringstream lines(said);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("$ ") || line.starts_with("{")) continue;
    const auto english = english_in(line);
    const bool known = std::any_of(excepted.begin(), excepted.end(),
                                   [&](const auto& one) { return line.find(one) != std::string::npos; });
    if (!english.empty() && !known) out.insert(english + "  in  " + line);
  }
  return out;
}

TEST(Chinese, LeavesNoEnglishSentenceInWhatGoldenCasesShow) {
  std::filesystem::current_path(golden_source());
  ::setenv("SOURCE_DATE_EPOCH", "1795000000", 1);
  std::set<std::string> left;
  for (const auto& each : golden_cases()) left.merge(english_lines(play_golden(each, " --lang zh").said));
  for (const auto& line : left) ADD_FAILURE() << line;
}

TEST(Chinese, LeavesNoEnglishSentenceInHelp) {
  std::set<std::string> left;
  const auto look = [&](std::string_view path) {
    const auto text = command::help_text(path, 100, true);
    ASSERT_TRUE(text) << path;
    left.merge(english_lines(*text));
  };
  look("");
  for (const auto* command : command::registry()) look(command->path);
  for (const auto& word : command::prompt_words()) look(word.name);
  for (const auto& line : left) ADD_FAILURE() << line;
}

/// The `error` of each document, up to what an abort code is called, or to its end.
std::vector<std::string> errors_of(const std::string& said) {
  std::vector<std::string> out;
  for (auto at = said.find("\"error\":{"); at != std::string::npos; at = said.find("\"error\":{", at + 1)) {
    const auto end =
        std::min({said.find("\"abort\"", at), said.find("\"result\":", at), said.find('\n', at)});
    out.push_back(said.substr(at, end - at));
  }
  return out;
}

/// Chinese that is in no file of data.
std::string foreign_chinese(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = at;
    // CJK, and not `…` or `σ`: the first byte of three, from U+3000 on.
    while (end < text.size() && static_cast<unsigned char>(text[end]) >= 0xE3) end += 3;
    end = std::min(end, text.size());
    const auto words = std::string(text.substr(at, end - at));
    if (!words.empty() && english_data().find(words) == std::string::npos) return words;
    at = std::max(end, at + 1);
  }
  return {};
}

TEST(Chinese, IsInTheErrorsOfJsonOnlyWhereDataAre) {
  std::filesystem::current_path(golden_source());
  ::setenv("SOURCE_DATE_EPOCH", "1795000000", 1);
  std::size_t compared = 0;
  for (const auto& each : golden_cases()) {
    // What a test has found carries the titles of its criteria, in the language of its verdict.
    if (!each.name.starts_with("bad-") || each.name.starts_with("bad-test-")) continue;
    for (const auto& error : errors_of(play_golden(each, " --lang zh --json").said)) {
      ++compared;
      EXPECT_EQ(foreign_chinese(error), "") << each.name << "\n" << error;
    }
  }
  EXPECT_GT(compared, 50U);
}

TEST(Chinese, BreaksLinesBesideWideCharactersAndNotBeforeTheirMarks) {
  const auto text = command::help_text("jog", 60, true);
  ASSERT_TRUE(text);
  std::istringstream lines(*text);
  std::size_t longest = 0;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("  ")) longest = std::max(longest, display_width(line));
    const auto begin = std::string_view(line).substr(std::min(line.find_first_not_of(' '), line.size()));
    for (const std::string_view mark : {"，", "。", "；", "：", "）"})
      EXPECT_FALSE(begin.starts_with(mark)) << line;
  }
  EXPECT_LE(longest, 60U);
  EXPECT_GT(longest, 50U);
}

TEST(Chinese, HelpTakesNoTimeThatAnybodyNotices) {
  (void)command::help_text("jog", 80, true);
  const auto begin = std::chrono::steady_clock::now();
  (void)command::help_text("jog", 80, true);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(500));
}

TEST(Chinese, QuestionsAreAskedInIt) {
  RecordingConsole console;
  console.person = true;
  Shell::Options options;
  options.drive_folders = {golden_source() / "eds"};
  options.clock = sim::SimBus::Clock::virtual_time;
  options.defaults.bus = "sim:gsd600@1";
  Shell shell(console, std::move(options));
  EXPECT_EQ(LineRunner(shell).run("jog 60rpm --for 1s -n 1 -d gsd600 --turn 131072 --lang zh"), 8);
  ASSERT_EQ(console.questions.size(), 1U);
  EXPECT_EQ(english_in(console.questions.front()), "");
  EXPECT_NE(console.questions.front().find("节点 1"), std::string::npos) << console.questions.front();
  EXPECT_NE(console.err_text.find("错误："), std::string::npos) << console.err_text;
}

}  // namespace
}  // namespace servoctl::cli
