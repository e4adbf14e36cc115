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
#include "chinese_words.hpp"
#include "cli/terminal/completer.hpp"
#include "command/help_text.hpp"
#include "command/prompt_words.hpp"
#include "command/registry.hpp"
#include "drive/naming.hpp"
#include "drive/profile.hpp"
#include "report/chinese_marks.hpp"
#include "show/chinese_names.hpp"

namespace servoctl::cli {
namespace {

/// What stands in files that come from others: Chinese in an error of JSON is theirs.
const std::string& foreign_data() {
  static const std::string text = [] {
    std::string out;
    for (const auto* folder : {"eds", "tests/cli/data", "tests/cli/golden_cases.txt"}) {
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
    return out;
  }();
  return text;
}

class ChineseGolden : public testing::TestWithParam<GoldenCase> {};

/// `状态, 故障 (pp)` is written `状态，故障（pp）`: one way everywhere, whoever put the text together.
TEST_P(ChineseGolden, HasNoEnglishWordAndTheMarksOfChineseBesideIt) {
  std::filesystem::current_path(golden_source());
  ::setenv("SOURCE_DATE_EPOCH", "1795000000", 1);
  const auto said = play_golden(GetParam(), " --lang zh").said;
  for (const auto& line : english_lines(said)) ADD_FAILURE() << line;
  std::istringstream lines(said);
  for (std::string line; std::getline(lines, line);) {
    const bool data = line.starts_with("$ ") || line.starts_with("{") || line.starts_with("[exit");
    const bool left = std::ranges::any_of(
        exceptions().parts, [&](const std::string& part) { return line.find(part) != std::string::npos; });
    if (!data && !left) {
      EXPECT_EQ(report::chinese_marks(line), line);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, ChineseGolden, testing::ValuesIn(golden_cases()), golden_test_name);

TEST(Chinese, LeavesNoEnglishWordInHelp) {
  std::set<std::string> left;
  const auto look = [&](std::string_view path) {
    const auto text = command::help_text(path, 200, true);
    ASSERT_TRUE(text) << path;
    left.merge(english_lines(*text));
  };
  look("");
  for (const auto* command : command::registry()) look(command->path);
  for (const auto& word : command::prompt_words()) look(word.name);
  for (const auto& line : left) ADD_FAILURE() << line;
}

/// What Tab tells of each word, behind these lines.
TEST(Chinese, LeavesNoEnglishWordInWhatCompletionTells) {
  RecordingConsole console;
  Shell::Options options;
  options.drive_folders = {golden_source() / "eds"};
  options.clock = sim::SimBus::Clock::virtual_time;
  options.defaults.bus = "sim:gsd600@1";
  options.defaults.drive = "gsd600";
  options.defaults.chinese = true;
  Shell shell(console, std::move(options));
  std::vector<std::string> lines{"", "use ", "drive ", "bus ", "read -b ", "read -n ", "home ", "mode "};
  for (const auto* command : command::registry()) {
    lines.push_back(std::string(command->path) + " ");
    lines.push_back(std::string(command->path) + " -");
  }
  std::set<std::string> left;
  for (const auto& line : lines) {
    const auto offer = complete(line, shell);
    left.merge(english_lines(offer.note));
    for (const auto& one : offer.candidates) left.merge(english_lines(one.hint));
  }
  for (const auto& line : left) ADD_FAILURE() << line;
}

constexpr const char* kFamilies[] = {"cia402", "da200", "dm", "gsd600", "sv2", "ts"};

/// An error of `0x1A01:1` must not speak of RPDO1, whose entry has the same name in English.
TEST(Chinese, CallsEachEntryAndParameterByItsOwnName) {
  for (const auto* family : kFamilies) {
    const auto profile = drive::load_profile(family, std::vector{golden_source() / "eds"});
    ASSERT_TRUE(profile) << profile.error().message.text();
    const auto names = show::chinese_names(*profile);
    const auto look = [&](const drive::Target& target, const std::string& name, const std::string& chinese) {
      if (const auto alone = names.find(name); alone != names.end() && !chinese.empty()) {
        EXPECT_EQ(alone->second, chinese) << family << ' ' << to_string(target.address);
      }
      const auto told = names.find(target.in_sentence());
      if (chinese.empty() || chinese == name) return;
      ASSERT_NE(told, names.end()) << family << ' ' << target.in_sentence();
      EXPECT_TRUE(told->second.ends_with(" " + chinese)) << told->second;
    };
    for (const auto& object : profile->dictionary.objects())
      for (const auto& entry : object.entries) {
        const auto target = drive::target_at(&*profile, entry.address);
        if (target.parameter == nullptr) look(target, entry.name, entry.name_zh);
      }
    for (const auto& parameter : profile->parameters) {
      drive::Target target;
      target.parameter = &parameter;
      look(target, parameter.name, parameter.name_zh);
    }
  }
}

/// Names, labels, notes, remedies and topics of every family.
TEST(Chinese, LeavesNoEnglishWordInWhatIsToldOfTheFamilies) {
  std::filesystem::current_path(golden_source());
  std::set<std::string> left;
  const auto look = [&](std::string_view family, const std::string& text) {
    for (const auto& line : english_lines(text)) left.insert(std::string(family) + ": " + line);
    if (report::chinese_marks(text) != text) left.insert(std::string(family) + ": marks of " + text);
  };
  for (const auto* family : kFamilies) {
    const auto profile = drive::load_profile(family, std::vector{golden_source() / "eds"});
    ASSERT_TRUE(profile) << profile.error().message.text();
    const auto names = show::chinese_names(*profile);
    for (const auto& [english, chinese] : names) look(family, chinese);
    const auto has = [&](const std::string& name, const std::string& chinese) {
      if (report::chinese_marks(chinese) != chinese)
        left.insert(std::string(family) + ": marks of " + chinese);
      const bool plain = name.empty() || !chinese.empty() || english_words(name).empty();
      if (!plain) left.insert(std::string(family) + ": no Chinese of " + name);
    };
    // What the English corrects, it corrects by its index: `60E0h`.
    const auto names_the_same = [&](const std::string& english, const std::string& chinese) {
      static const std::regex kIndex("[0-9A-F]{4}h");
      for (std::sregex_iterator at(english.begin(), english.end(), kIndex), end; at != end; ++at)
        if (chinese.find(at->str()) == std::string::npos)
          left.insert(std::string(family) + ": no " + at->str() + " in " + chinese);
    };
    for (const auto& object : profile->dictionary.objects())
      for (const auto& entry : object.entries) {
        if (profile->parameter(entry.address) != nullptr) continue;
        has(entry.name, entry.name_zh);
        has(entry.note, entry.note_zh);
        names_the_same(entry.note, entry.note_zh);
        for (const auto& label : entry.labels) has(label.label, label.label_zh);
      }
    for (const auto& parameter : profile->parameters) {
      has(parameter.name, parameter.name_zh);
      has(parameter.note, parameter.note_zh);
      names_the_same(parameter.note, parameter.note_zh);
      for (const auto& label : parameter.labels) has(label.label, label.label_zh);
    }
    for (const auto& fault : profile->faults) {
      has(fault.name, fault.name_zh);
      has(fault.check, fault.check_zh);
      names_the_same(fault.check, fault.check_zh);
    }
  }
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
    if (!words.empty() && foreign_data().find(words) == std::string::npos) return words;
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
  EXPECT_EQ(english_lines(console.questions.front()), std::set<std::string>());
  EXPECT_NE(console.questions.front().find("节点 1"), std::string::npos) << console.questions.front();
  EXPECT_NE(console.err_text.find("错误："), std::string::npos) << console.err_text;
  EXPECT_NE(console.err_text.find("正常     状态："), std::string::npos) << console.err_text;
  EXPECT_NE(console.err_text.find("备注     最大速度："), std::string::npos) << console.err_text;
}

}  // namespace
}  // namespace servoctl::cli
