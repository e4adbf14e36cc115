#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <utility>

#include "drive/profile.hpp"
#include "lying_node.hpp"
#include "od/eds.hpp"
#include "settings/learning.hpp"
#include "settings/scan_file.hpp"
#include "show/desk.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::settings {

inline std::string content_of(const std::filesystem::path& path) {
  std::ostringstream out;
  out << std::ifstream(path).rdbuf();
  return out.str();
}

/// A drive of which nobody has a data sheet, and a folder for what is learned of it.
class LearningWorld : public testing::Test {
 protected:
  LearningWorld()
      : standard(drive::load_profile("cia402", kFolders).value()),
        family(drive::load_profile("gsd600", kFolders).value()),
        folder(std::filesystem::temp_directory_path() / fmt::format("servoctl-learn-{}", ::getpid())),
        file(folder / "drive.eds") {
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    ::setenv("SOURCE_DATE_EPOCH", "1795000000", 1);
    begin_anew();
  }
  ~LearningWorld() override { std::filesystem::remove_all(folder); }

  /// The same drive, and another run of the program.
  void begin_anew() {
    node = std::make_unique<LyingNode>(family.dictionary);
    for (std::uint8_t sub = 1; sub <= 4; ++sub) node->objects.values[{0x1018, sub}] = {sub, 1, 0, 0};
  }

  Result<report::Record> learn(const LearnOptions& options = {}) {
    desk = {};
    desk.session = &*node->session;
    desk.standard = &standard;
    return learn_sheet(desk, 1, file, options);
  }
  od::EdsFile learned(const LearnOptions& options = {}) {
    const auto done = learn(options);
    EXPECT_TRUE(done) << done.error().message.text();
    auto out = od::read_eds(content_of(file), "drive.eds");
    EXPECT_TRUE(out);
    EXPECT_EQ(out->error_count() + out->warning_count(), 0U);
    EXPECT_FALSE(std::filesystem::exists(scan_file(file)));
    EXPECT_TRUE(node->objects.writes.empty());
    return std::move(*out);
  }

  drive::Profile standard;
  drive::Profile family;
  std::filesystem::path folder;
  std::filesystem::path file;
  std::unique_ptr<LyingNode> node;
  show::Desk desk;
};

}  // namespace servoctl::settings
