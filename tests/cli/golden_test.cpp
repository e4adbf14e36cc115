// Golden command-line cases: tests/cli/golden/cases.txt names them, one file each holds what the program must
// say, as text and as JSON. `./dev golden` writes the files anew; read the diff.
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <unistd.h>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/printable.hpp"
#include "cli/line_runner.hpp"
#include "cli/shell.hpp"
#include "cli/words.hpp"
#include "recording_console.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;

const fs::path kSource = source_dir();
const fs::path kFolder = kSource / "tests/cli/golden";

struct Case {
  std::string name;
  std::vector<std::string> lines;  ///< Separated by ` ;; `, run one after the other on the same bus.
};

/// The lines of a script, run on one simulated drive of the family: `sv2`, or `coe:sv2` on EtherCAT.
Case script_case(std::string name, const std::string& path, const std::string& where) {
  constexpr std::string_view kRing = "coe:";
  const bool ring = where.starts_with(kRing);
  const auto family = ring ? where.substr(kRing.size()) : where;
  const auto bus = (ring ? "coe:sim:" : "sim:") + family + "@1";
  Case out{std::move(name), {}};
  std::ifstream file(kSource / path);
  std::string line;
  while (std::getline(file, line)) {
    if (line.empty() || line.front() == '#') continue;
    if (const auto place = line.find("FAMILY"); place != std::string::npos) line.replace(place, 6, family);
    out.lines.push_back(line + " -b " + bus + " -d " + family + " -n 1");
  }
  return out;
}

/// What must not stand in a file people read.
std::string with_controls(std::string line) {
  constexpr std::pair<std::string_view, std::string_view> kControls[] = {
      {"{ESC}", "\x1B"}, {"{9B}", "\x9B"}, {"{RLO}", "\u202E"}};
  for (const auto& [mark, control] : kControls)
    for (auto at = line.find(mark); at != std::string::npos; at = line.find(mark))
      line.replace(at, mark.size(), control);
  return line;
}

std::vector<Case> read_cases() {
  std::vector<Case> out;
  std::ifstream file(kFolder / "cases.txt");
  std::string line;
  while (std::getline(file, line)) {
    if (line.empty() || line.front() == '#') continue;
    line = with_controls(line);
    const auto colon = line.find(": ");
    Case c{line.substr(0, colon), {}};
    auto rest = line.substr(colon + 2);
    if (rest.front() == '@') {
      const auto space = rest.find(' ');
      out.push_back(script_case(c.name, rest.substr(1, space - 1), rest.substr(space + 1)));
      continue;
    }
    for (std::size_t at = 0; (at = rest.find(" ;; ")) != std::string::npos; rest = rest.substr(at + 4))
      c.lines.push_back(rest.substr(0, at));
    c.lines.push_back(rest);
    out.push_back(std::move(c));
  }
  return out;
}

struct Played {
  std::string said;
  int exit = 0;  ///< Of the last line.
};

/// Runs the lines of a case and tells all that came of them.
Played play(const Case& c, bool json) {
  RecordingConsole console;
  Shell::Options options;
  options.drive_folders = {kSource / "eds", kSource / "tests/cli/data/drives"};
  options.clock = sim::SimBus::Clock::virtual_time;
  options.defaults.bus = "sim:gsd600@1";
  // What is explained has families of its own, so that no case changes with what is known of others.
  if (c.name.starts_with("explain") || c.name.starts_with("bad-explain"))
    options.drive_folders = {kSource / "tests/cli/data/explain"};
  // Cases of what is kept begin with nothing kept.
  const bool keeps = c.name.starts_with("units-") || c.name.starts_with("bad-units-");
  const auto state = fs::temp_directory_path() / fmt::format("servoctl-golden-{}-{}", ::getpid(), c.name);
  if (keeps) fs::create_directories(options.state_folder = state);
  Shell shell(console, std::move(options));
  LineRunner runner(shell);
  Played out;
  for (const auto& line : c.lines) {
    console.out_text.clear();
    console.err_text.clear();
    const auto typed = json ? line + " --json" : line;
    out.exit = runner.run(typed);
    out.said += fmt::format("$ {}\n", printable(typed)) + console.out_text;
    if (!console.err_text.empty()) out.said += "[stderr]\n" + console.err_text;
    out.said += fmt::format("[exit {}]\n\n", out.exit);
  }
  fs::remove_all(state);
  return out;
}

std::string slurp(const fs::path& path) {
  std::ifstream file(path);
  std::ostringstream out;
  out << file.rdbuf();
  return out.str();
}

class Golden : public testing::TestWithParam<Case> {};

TEST_P(Golden, SaysWhatItSaidBefore) {
  fs::current_path(kSource);
  ::setenv("SOURCE_DATE_EPOCH", "1795000000", 1);
  // Whole tables are long enough once.
  const bool table = GetParam().name.starts_with("table-") || GetParam().name.starts_with("commission-");
  const auto text = play(GetParam(), false);
  const auto json = table ? Played{} : play(GetParam(), true);
  if (GetParam().name.starts_with("bad-")) {
    EXPECT_NE(text.exit, 0) << "a case that goes well is not called bad";
    EXPECT_NE(json.exit, 0) << "with --json";
  }
  const auto said = text.said + json.said;
  const auto path = kFolder / (GetParam().name + ".txt");
  if (std::getenv("SERVOCTL_REWRITE_GOLDEN") != nullptr) {
    std::ofstream(path) << said;
    return;
  }
  EXPECT_EQ(slurp(path), said) << "`./dev golden` writes " << path << " anew";
}

INSTANTIATE_TEST_SUITE_P(Cases, Golden, testing::ValuesIn(read_cases()),
                         [](const testing::TestParamInfo<Case>& c_info) {
                           std::string name = c_info.param.name;
                           for (auto& c : name)
                             if (c == '-') c = '_';
                           return name;
                         });

TEST(GoldenCases, EveryFileBelongsToACase) {
  const auto cases = read_cases();
  ASSERT_GT(cases.size(), 40U);
  for (const auto& entry : fs::directory_iterator(kFolder)) {
    const auto stem = entry.path().stem().string();
    if (stem == "cases") continue;
    EXPECT_TRUE(std::any_of(cases.begin(), cases.end(), [&](const Case& c) { return c.name == stem; }))
        << entry.path();
  }
}

}  // namespace
}  // namespace servoctl::cli
