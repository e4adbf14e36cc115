// What `servoctl cabinet` refuses: tests/cli/cabinet/errors.txt has the files and the lines, said.txt what is
// said of them. `./dev golden` writes it anew; read the diff.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <utility>

#include "base/file.hpp"
#include "base/text.hpp"
#include "chinese_words.hpp"
#include "golden_cases.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;

struct ErrorCase {
  std::string name;
  std::vector<std::string> lines;
  std::map<std::string, std::string> files;
};

fs::path errors_folder() { return golden_source() / "tests/cli/cabinet"; }

std::vector<ErrorCase> error_cases() {
  std::vector<ErrorCase> out;
  std::ifstream file(errors_folder() / "errors.txt");
  std::string line;
  std::string into;
  while (std::getline(file, line)) {
    if (line.starts_with("== ")) {
      out.push_back({line.substr(3), {}, {}});
      into = "cabinet.toml";
    } else if (!out.empty() && line.starts_with("$ ")) {
      out.back().lines.push_back(line.substr(2));
    } else if (!out.empty() && line.starts_with("@ ")) {
      into = line.substr(2);
    } else if (!out.empty() && !line.empty()) {
      out.back().files[into] += line + "\n";
    }
  }
  return out;
}

/// In a folder of its own, with the state of nobody.
std::string played(const ErrorCase& c, const fs::path& folder, bool chinese = false) {
  fs::remove_all(folder);
  fs::create_directories(folder);
  fs::current_path(folder);
  for (const auto& [name, text] : c.files) {
    fs::create_directories((folder / name).parent_path());
    std::ofstream(folder / name) << text;
  }
  RecordingConsole console;
  Shell::Options options;
  options.drive_folders = {golden_source() / "eds"};
  options.clock = sim::SimBus::Clock::virtual_time;
  // Named from here, so that no path of this folder makes a table wider.
  options.defaults.cabinet = c.files.count("cabinet.toml") != 0 ? "cabinet.toml" : "";
  if (c.files.empty()) options.defaults.bus = "sim:gsd600@1,da200@2";
  options.defaults.chinese = chinese;
  options.state_folder = folder / "state";
  fs::create_directories(options.state_folder);
  Shell shell(console, std::move(options));
  LineRunner runner(shell);
  std::string out = fmt::format("== {}\n", c.name);
  bool refused = false;
  for (const auto& line : c.lines.empty() ? std::vector<std::string>{"cabinet check"} : c.lines) {
    console.out_text.clear();
    console.err_text.clear();
    const int code = runner.run(line);
    refused = refused || code != 0 || !console.err_text.empty();
    out += fmt::format("$ {}\n{}", line, console.out_text);
    if (!console.err_text.empty()) out += "[stderr]\n" + console.err_text;
    out += fmt::format("[exit {}]\n", code);
  }
  EXPECT_TRUE(refused) << c.name << ": everything went well";
  return out + "\n";
}

TEST(CabinetErrors, SayWhatTheySaidBefore) {
  const auto cases = error_cases();
  ASSERT_GT(cases.size(), 50U);
  ::setenv("SOURCE_DATE_EPOCH", "1795000000", 1);
  const auto before = fs::current_path();
  const auto folder = fs::temp_directory_path() / fmt::format("servoctl-cabinet-errors-{}", ::getpid());
  std::string said;
  for (const auto& c : cases) said += played(c, folder);
  fs::current_path(before);
  fs::remove_all(folder);
  EXPECT_EQ(said.find(folder.string()), std::string::npos) << "a path of this machine";
  const auto golden = errors_folder() / "said.txt";
  if (std::getenv("SERVOCTL_REWRITE_GOLDEN") != nullptr) {
    std::ofstream(golden) << said;
    return;
  }
  const auto expected = read_file(golden);
  ASSERT_TRUE(expected);
  EXPECT_EQ(*expected, said) << "`./dev golden` writes " << golden << " anew";
}

/// Words that the files and lines of the case have are theirs, and keys of a cabinet file are typed as they
/// are.
std::set<std::string> own_words(const ErrorCase& c) {
  std::string text = "encoder gear limits pdos turn url key value local ";
  for (const auto& line : c.lines) text += line + " ";
  for (const auto& [name, content] : c.files) text += name + " " + content + " ";
  std::set<std::string> out;
  std::string word;
  for (const char letter : text + " ") {
    const bool is_word =
        (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') || letter == '-';
    if (is_word) word += letter;
    if (!is_word && !word.empty()) out.insert(std::exchange(word, {}));
  }
  return out;
}

TEST(CabinetErrors, AreInChineseForWhoReadsIt) {
  ::setenv("SOURCE_DATE_EPOCH", "1795000000", 1);
  const auto before = fs::current_path();
  const auto folder = fs::temp_directory_path() / fmt::format("servoctl-cabinet-chinese-{}", ::getpid());
  std::set<std::string> left;
  for (const auto& c : error_cases()) {
    const auto own = own_words(c);
    std::istringstream lines(played(c, folder, true));
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("== ") || line.starts_with("$ ") || line.starts_with("[")) continue;
      for (const auto& word : english_words(line))
        if (own.count(word) == 0) left.insert(fmt::format("{}  in  {}: {}", word, c.name, line));
    }
  }
  fs::current_path(before);
  fs::remove_all(folder);
  for (const auto& line : left) ADD_FAILURE() << line;
}

}  // namespace
}  // namespace servoctl::cli
