// Every hint of the golden cases that names a command is followed: typed as it is printed it is understood,
// and it asks for nothing that was given.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>

#include "cli/batch/batch_command.hpp"
#include "cli/line_runner.hpp"
#include "cli/parse.hpp"
#include "cli/words.hpp"
#include "command/registry.hpp"
#include "recording_console.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/// A hint, or what mends a finding, and the line that was given it.
struct Hint {
  std::string name;  ///< Of the golden case.
  std::string line;
  std::string text;
};

std::vector<Hint> all_hints() {
  std::vector<Hint> out;
  for (const auto& entry : fs::directory_iterator(fs::path(source_dir()) / "tests/cli/golden")) {
    std::ifstream file(entry.path());
    std::string name;
    std::string line;
    for (std::string text; std::getline(file, text);) {
      if (text.starts_with("=== ")) name = text.substr(4);
      if (text.starts_with("$ ")) line = text.substr(2);
      if (line.ends_with(" --json")) continue;
      // What `doctor` says that mends a finding is a hint too.
      for (const std::string_view mark : {"  hint: ", "  mend: "})
        if (const auto at = text.find(mark); at != std::string::npos && at + 2 == text.find_first_not_of(' '))
          out.push_back({name, line, text.substr(at + mark.size())});
    }
  }
  return out;
}

/// What stands in backquotes.
std::vector<std::string> quoted(const std::string& text) {
  std::vector<std::string> out;
  const std::regex mark("`([^`]+)`");
  for (std::sregex_iterator it(text.begin(), text.end(), mark); it != std::sregex_iterator(); ++it)
    out.push_back((*it)[1]);
  return out;
}

/// Words that stand for others.
std::string filled_in(std::string text) {
  const std::pair<std::string_view, std::string_view> kWords[] = {{"test …", "test comm"},
                                                                  {"param set …", "param set Fn_33=2"},
                                                                  {" METHOD", " 35"},
                                                                  {" PATTERN", " speed"},
                                                                  {" WORD", " speed"},
                                                                  {" OBJECT…", " controlword"},
                                                                  {" >FILE", ""},
                                                                  {" FILE", " /tmp/x"},
                                                                  {" …", " "}};
  for (const auto& [from, to] : kWords)
    if (const auto at = text.find(from); at != std::string::npos) text.replace(at, from.size(), to);
  return text;
}

/// Commands of others, words of batch files and values.
const std::set<std::string> kNoCommands{"candump -L",
                                        "all",
                                        "end",
                                        "use 1",
                                        "use 1,3,5-8",
                                        "use all",
                                        "time:ms,-,id:dec,len,data",
                                        "id=CAN ID,data=Payload",
                                        "time date id len data byte type channel ext rtr error -",
                                        "?columns=time,id:hex,data:hex"};

bool lacks_words(const Words& words) {
  const auto parsed = parse_line(words);
  return !parsed && parsed.error().message.text().ends_with(" is missing");
}

/// What the line answers on a simulated drive.
Outcome followed(const Words& words) {
  RecordingConsole console;
  Shell::Options options;
  options.drive_folders = {fs::path(source_dir()) / "eds", fs::path(source_dir()) / "tests/cli/data/drives"};
  // As the golden cases: what is explained has families of its own.
  if (std::find(words.begin(), words.end(), "x1") != words.end())
    options.drive_folders = {fs::path(source_dir()) / "tests/cli/data/explain"};
  options.clock = sim::SimBus::Clock::virtual_time;
  options.defaults.bus = "sim:gsd600@1";
  options.defaults.yes = true;
  options.cancelled = [] { return true; };
  Shell shell(console, std::move(options));
  return shell.perform(words);
}

TEST(Hints, NameCommandsThatRunAsTheyArePrinted) {
  fs::current_path(source_dir());
  int commands = 0;
  for (const auto& hint : all_hints())
    for (const auto& text : quoted(hint.text)) {
      SCOPED_TRACE(hint.name + ": " + hint.line + "\n" + hint.text);
      const auto refused = split_words(hint.line).value();
      auto words = split_words(filled_in(text));
      ASSERT_TRUE(words) << text;
      if (text.starts_with("--") && kNoCommands.count(text) == 0) {
        words->insert(words->begin(), refused.begin(), refused.end());
      } else if (match_command(*words).command == nullptr) {
        EXPECT_TRUE(kNoCommands.count(text) > 0) << "`" << text << "` is no command";
        continue;
      } else if (lacks_words(*words) || hint.name == "bad-group" || hint.name == "bad-meaning") {
        // A command that is only named.
        EXPECT_NE(command::find_command(text), nullptr) << text;
        continue;
      }
      ++commands;
      // With a word that stands for others it is completed, and its place is: else it is as it is printed.
      auto line = *words;
      const auto has = [](const Words& in, std::string_view option) {
        return std::find(in.begin(), in.end(), option) != in.end();
      };
      const bool open = text.find("…") != std::string::npos;
      const bool needs_node = includes(match_command(line).command->needs, command::Needs::node);
      if (needs_node && !has(line, "-n") && (open || !has(refused, "-n")))
        line.insert(line.end(), {"-n", "1"});
      if (open && has(refused, "-d") && !has(line, "-d"))
        line.insert(line.end(), {"-d", *(std::find(refused.begin(), refused.end(), "-d") + 1)});
      // Lines of a file choose drive and node themselves.
      if (refused.front() == "run") line.insert(line.end(), {"-d", "gsd600", "-n", "1"});
      const auto outcome = followed(line);
      EXPECT_NE(outcome.code(), exit_code(Errc::usage))
          << text << ": " << (outcome.errors.empty() ? "" : outcome.errors.front().message.text());
    }
  EXPECT_GT(commands, 50);
}

TEST(Hints, AskForNothingThatWasGiven) {
  const std::regex mark("add (-{1,2}[a-z-]+)( [^ ,;:]+)?");
  int asked = 0;
  for (const auto& hint : all_hints()) {
    const auto words = split_words(hint.line);
    if (!words) continue;
    for (std::sregex_iterator it(hint.text.begin(), hint.text.end(), mark); it != std::sregex_iterator();
         ++it) {
      ++asked;
      const auto given = std::find(words->begin(), words->end(), (*it)[1].str());
      if (given == words->end()) continue;
      // Another value is another thing: `add -d da200` where gsd600 was named.
      const auto value = (*it)[2].str();
      const bool other = !value.empty() && std::islower(static_cast<unsigned char>(value[1])) != 0 &&
                         given + 1 != words->end() && value.substr(1) != *(given + 1);
      EXPECT_TRUE(other) << hint.name << ": " << hint.line << "\n" << hint.text;
    }
  }
  EXPECT_GT(asked, 15);
}

}  // namespace
}  // namespace servoctl::cli
