#pragma once

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <unistd.h>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

#include "cli/line_runner.hpp"
#include "cli/shell.hpp"
#include "recording_console.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {

/// Runs command lines on simulated drives, with a folder of its own for files.
class BackupTest : public testing::Test {
 protected:
  void SetUp() override {
    folder = std::filesystem::temp_directory_path() / fmt::format("servoctl-backup-{}", ::getpid());
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    ::setenv("SOURCE_DATE_EPOCH", "1795000000", 1);
  }
  void TearDown() override {
    ::unsetenv("SOURCE_DATE_EPOCH");
    std::filesystem::remove_all(folder);
  }

  /// Runs a line on the bus; a file is named by %, in the test's folder.
  int run(std::string line) {
    console.out_text.clear();
    console.err_text.clear();
    for (auto place = line.find('%'); place != std::string::npos; place = line.find('%'))
      line.replace(place, 1, folder.string() + "/");
    return LineRunner(shell()).run(line);
  }
  void use(const std::string& bus, const std::string& family) {
    shell_.reset();
    bus_ = bus;
    family_ = family;
  }
  Shell& shell() {
    if (!shell_) {
      Shell::Options options;
      options.drive_folders = {folder, eds};
      options.clock = sim::SimBus::Clock::virtual_time;
      options.defaults.bus = bus_;
      options.defaults.drive = family_;
      options.defaults.nodes = "1";
      shell_ = std::make_unique<Shell>(console, std::move(options));
    }
    return *shell_;
  }
  std::string slurp(const std::string& name) {
    std::ostringstream out;
    out << std::ifstream(folder / name).rdbuf();
    return out.str();
  }
  void spill(const std::string& name, const std::string& text) { std::ofstream(folder / name) << text; }
  std::string replaced(std::string text, std::string_view from, std::string_view to) {
    const auto place = text.find(from);
    EXPECT_NE(place, std::string::npos) << from;
    return place == std::string::npos ? text : text.replace(place, from.size(), to);
  }

  std::filesystem::path folder;  ///< Families that stand here win over those of the program.
  const std::filesystem::path eds = std::filesystem::path(source_dir()) / "eds";
  RecordingConsole console;

 private:
  std::string bus_ = "sim:gsd600@1";
  std::string family_ = "gsd600";
  std::unique_ptr<Shell> shell_;
};

}  // namespace servoctl::cli
