#pragma once

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <unistd.h>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <set>
#include <sstream>
#include <thread>

#include "cli/line_runner.hpp"
#include "cli/shell.hpp"
#include "cli/terminal/completer.hpp"
#include "recording_console.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {

namespace fs = std::filesystem;

/// A shell beside a cabinet file of three buses and families.
class AxisLines : public testing::Test {
 protected:
  AxisLines() : folder(fs::temp_directory_path() / ("servoctl-axes-" + std::to_string(::getpid()))) {
    fs::create_directories(folder);
    write(R"([bus.main]
url = "sim:gsd600@1,gsd600@2,da200@3"
[bus.ring]
url = "coe:sim:sv2@1"
[group.feeders]
bus = "main"
family = "gsd600"
turn = 10000
gear = "10:1"
per_turn = "20 mm"
limits = { speed = "100mm/s" }
[axis."feeder{1-2}"]
node = "1-2"
group = "feeders"
[axis."送料"]
bus = "main"
node = 3
family = "da200"
[axis.table]
bus = "ring"
node = 1
family = "sv2"
)");
    Shell::Options options;
    options.drive_folders = {fs::path(source_dir()) / "eds"};
    options.clock = sim::SimBus::Clock::virtual_time;
    options.defaults.cabinet = folder / "cabinet.toml";
    shell = std::make_unique<Shell>(console, options);
    shell->stay_open(true);
  }
  ~AxisLines() override { fs::remove_all(folder); }

  void write(const std::string& text) const { std::ofstream(folder / "cabinet.toml") << text; }
  int run(std::string_view line) {
    console.out_text.clear();
    console.err_text.clear();
    return LineRunner(*shell).run(line);
  }
  static std::string content(const fs::path& file) {
    std::stringstream out;
    out << std::ifstream(file).rdbuf();
    return out.str();
  }
  std::string all() const { return console.out_text + console.err_text; }
  bool says(std::string_view what) const { return all().find(what) != std::string::npos; }

  fs::path folder;
  RecordingConsole console;
  std::unique_ptr<Shell> shell;
};

}  // namespace servoctl::cli
