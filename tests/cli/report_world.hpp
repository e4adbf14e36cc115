#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>

#include "cli/line_runner.hpp"
#include "recording_console.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {

/// Lines on simulated drives in virtual time, and a folder for the files that they write.
class ReportWorld : public testing::Test {
 protected:
  explicit ReportWorld(std::string bus = {}, std::string family = {})
      : bus_(std::move(bus)), family_(std::move(family)) {
    std::filesystem::create_directories(dir_);
  }
  ~ReportWorld() override { std::filesystem::remove_all(dir_); }

  /// The exit code.
  int run(const std::string& line) {
    console.out_text.clear();
    console.err_text.clear();
    Shell::Options options;
    options.drive_folders = {std::filesystem::path(source_dir()) / "eds"};
    options.clock = sim::SimBus::Clock::virtual_time;
    options.defaults.bus = bus_;
    options.defaults.drive = family_;
    Shell shell(console, std::move(options));
    return LineRunner(shell).run(line);
  }

  /// The report that a line writes which ends with this exit code.
  std::string report(const std::string& name, const std::string& options, int exit = 0) {
    EXPECT_EQ(run("report " + (dir_ / name).string() + " " + options), exit) << console.err_text;
    std::ostringstream text;
    text << std::ifstream(dir_ / name).rdbuf();
    return text.str();
  }

  std::string file(const std::string& name, std::string_view content) const {
    std::ofstream(dir_ / name) << content;
    return (dir_ / name).string();
  }

  RecordingConsole console;
  const std::filesystem::path dir_ = std::filesystem::temp_directory_path() / "report-world";

 private:
  std::string bus_;
  std::string family_;
};

}  // namespace servoctl::cli
