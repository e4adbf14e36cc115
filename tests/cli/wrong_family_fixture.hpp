#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <set>

#include "base/text.hpp"
#include "can/trace.hpp"
#include "cli/shell.hpp"
#include "cli/words.hpp"
#include "command/registry.hpp"
#include "obeying.hpp"
#include "recording_console.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {

namespace fs = std::filesystem;

class WrongFamily : public testing::Test {
 protected:
  WrongFamily() {
    fs::create_directories(folder_);
    std::ofstream(folder_ / "recording.log")
        << "(1.000000) can0 601#2F60600003000000\n(1.010000) can0 601#2B40600006000000\n";
  }
  ~WrongFamily() override { fs::remove_all(folder_); }

  /// A shell on two drives of one family, with the other one named.
  void open(const std::string& drive, const std::string& named) {
    shell_.reset();
    Shell::Options options;
    options.drive_folders = {fs::path(source_dir()) / "eds"};
    options.clock = sim::SimBus::Clock::virtual_time;
    options.defaults.bus = "sim:" + drive + "@1," + drive + "@2" + obeying(drive);
    options.defaults.nodes = "1";
    options.defaults.drive = named;
    options.defaults.trace = folder_ / "trace";
    shell_ = std::make_unique<Shell>(console_, std::move(options));
  }
  int run(std::string line, std::string_view more = "--yes") {
    if (const auto place = line.find(" %"); place != std::string::npos)
      line.replace(place + 1, 1, folder_.string() + "/");
    console_.out_text.clear();
    console_.err_text.clear();
    const int code = shell_->run(split_words(line + " " + std::string(more)).value());
    said = console_.out_text + console_.err_text;
    return code;
  }
  /// Closes the bus and takes what was sent to the drives out of its trace.
  void close() {
    shell_.reset();
    read_trace();
  }
  int run(const std::string& line, const std::string& drive, const std::string& named,
          std::string_view more = "--yes") {
    open(drive, named);
    const int code = run(line, more);
    close();
    return code;
  }

  void read_trace() {
    written.clear();
    sent = 0;
    std::ifstream file(folder_ / "trace");
    std::string line;
    while (std::getline(file, line)) {
      const auto frame = can::parse_log_line(line);
      if (!frame) continue;
      const auto id = frame->frame.id;
      const auto command = frame->frame.data[0] >> 5U;
      const bool request = id > 0x600 && id < 0x680;
      sent += request;
      // Anything but the reads of SDO: initiate, segment, block, and aborts.
      const bool read =
          request && (command == 2 || command == 3 || command == 5 || frame->frame.data[0] == 0x80);
      const bool rpdo = id >= 0x200 && id < 0x580 && (id & 0x80U) == 0;
      if ((request && !read) || id == 0 || rpdo) written.push_back(line);
    }
  }

  RecordingConsole console_;
  std::unique_ptr<Shell> shell_;
  const fs::path folder_ = fs::path(testing::TempDir()) / (std::to_string(::getpid()) + "-wrong-family");
  std::string said;
  std::vector<std::string> written;
  int sent = 0;
};

}  // namespace servoctl::cli
