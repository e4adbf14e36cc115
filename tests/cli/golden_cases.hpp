#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "base/printable.hpp"
#include "cli/line_runner.hpp"
#include "cli/shell.hpp"
#include "obeying.hpp"
#include "recording_console.hpp"
#include "tests/source_dir.hpp"

/// The cases of tests/cli/golden_cases.txt.
namespace servoctl::cli {

inline std::filesystem::path golden_source() { return source_dir(); }
inline std::filesystem::path golden_folder() { return golden_source() / "tests/cli/golden"; }

struct GoldenCase {
  std::string name;
  std::vector<std::string> lines;  ///< Separated by ` ;; `, run one after the other on the same bus.

  /// What is said of it stands in the file of its first word, `bad-` left out: that of `bad-read-axis` is
  /// read.txt.
  std::filesystem::path file() const {
    constexpr std::string_view kBad = "bad-";
    const auto rest = name.substr(name.starts_with(kBad) ? kBad.size() : 0);
    return golden_folder() / (rest.substr(0, rest.find('-')) + ".txt");
  }
};

/// The lines of a script, run on one simulated drive of the family: `sv2`, or `coe:sv2` on EtherCAT.
inline GoldenCase golden_script(std::string name, const std::string& path, const std::string& where) {
  constexpr std::string_view kRing = "coe:";
  const bool ring = where.starts_with(kRing);
  const auto family = ring ? where.substr(kRing.size()) : where;
  const auto bus = (ring ? "coe:sim:" : "sim:") + family + "@1" + obeying(family);
  GoldenCase out{std::move(name), {}};
  std::ifstream file(golden_source() / path);
  std::string line;
  while (std::getline(file, line)) {
    if (line.empty() || line.front() == '#') continue;
    if (const auto place = line.find("FAMILY"); place != std::string::npos) line.replace(place, 6, family);
    out.lines.push_back(line + " -b " + bus + " -d " + family + " -n 1");
  }
  return out;
}

/// What must not stand in a file people read.
inline std::string with_golden_controls(std::string line) {
  constexpr std::pair<std::string_view, std::string_view> kControls[] = {
      {"{ESC}", "\x1B"}, {"{9B}", "\x9B"}, {"{RLO}", "\u202E"}};
  for (const auto& [mark, control] : kControls)
    for (auto at = line.find(mark); at != std::string::npos; at = line.find(mark))
      line.replace(at, mark.size(), control);
  return line;
}

inline std::vector<GoldenCase> golden_cases() {
  std::vector<GoldenCase> out;
  std::ifstream file(golden_source() / "tests/cli/golden_cases.txt");
  std::string line;
  while (std::getline(file, line)) {
    if (line.empty() || line.front() == '#') continue;
    line = with_golden_controls(line);
    const auto colon = line.find(": ");
    GoldenCase c{line.substr(0, colon), {}};
    auto rest = line.substr(colon + 2);
    if (rest.front() == '@') {
      const auto space = rest.find(' ');
      out.push_back(golden_script(c.name, rest.substr(1, space - 1), rest.substr(space + 1)));
      continue;
    }
    for (std::size_t at = 0; (at = rest.find(" ;; ")) != std::string::npos; rest = rest.substr(at + 4))
      c.lines.push_back(rest.substr(0, at));
    c.lines.push_back(rest);
    out.push_back(std::move(c));
  }
  return out;
}

/// The name of the case as part of that of its test.
inline std::string golden_test_name(const testing::TestParamInfo<GoldenCase>& info) {
  std::string out = info.param.name;
  std::ranges::replace(out, '-', '_');
  return out;
}

struct PlayedGolden {
  std::string said;
  int exit = 0;  ///< Of the last line.
};

/// Runs the lines of a case, each with these options behind it, and tells all that came of them.
/// `prepare` says what else the console is.
inline PlayedGolden play_golden(const GoldenCase& c, const std::string& options_behind,
                                const std::function<void(RecordingConsole&)>& prepare = {}) {
  RecordingConsole console;
  if (prepare) prepare(console);
  Shell::Options options;
  options.drive_folders = {golden_source() / "eds", golden_source() / "tests/cli/data/drives"};
  options.clock = sim::SimBus::Clock::virtual_time;
  options.defaults.bus = "sim:gsd600@1";
  // What is explained has families of its own, so that no case changes with what is known of others.
  if (c.name.starts_with("explain") || c.name.starts_with("bad-explain"))
    options.drive_folders = {golden_source() / "tests/cli/data/explain"};
  // Cases of what is kept begin with nothing kept.
  const bool keeps = c.name.starts_with("units-") || c.name.starts_with("bad-units-");
  const auto state =
      std::filesystem::temp_directory_path() / fmt::format("servoctl-golden-{}-{}", ::getpid(), c.name);
  if (keeps) std::filesystem::create_directories(options.state_folder = state);
  Shell shell(console, std::move(options));
  LineRunner runner(shell);
  PlayedGolden out;
  for (const auto& line : c.lines) {
    console.out_text.clear();
    console.err_text.clear();
    const auto typed = line + options_behind;
    out.exit = runner.run(typed);
    out.said += fmt::format("$ {}\n", printable(typed)) + console.out_text;
    if (!console.err_text.empty()) out.said += "[stderr]\n" + console.err_text;
    out.said += fmt::format("[exit {}]\n\n", out.exit);
  }
  std::filesystem::remove_all(state);
  return out;
}

}  // namespace servoctl::cli
