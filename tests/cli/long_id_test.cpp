// PDOs whose CAN-ID has 29 bits: shown, watched, decoded, sent and taken, or refused from the start.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "cli/line_runner.hpp"
#include "cli/shell.hpp"
#include "recording_console.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;

class LongId : public testing::Test {
 protected:
  ~LongId() override { fs::remove_all(folder_); }
  void use(const std::string& bus, const std::string& family) {
    Shell::Options options;
    options.drive_folders = {fs::path(source_dir()) / "eds"};
    options.clock = sim::SimBus::Clock::virtual_time;
    options.defaults.bus = bus;
    options.defaults.drive = family;
    options.defaults.nodes = "1";
    options.defaults.trace = folder_ / "trace.log";
    fs::create_directories(folder_);
    shell_ = std::make_unique<Shell>(console_, options);
  }
  int run(std::string_view line) {
    console_.out_text.clear();
    console_.err_text.clear();
    return LineRunner(*shell_).run(line);
  }
  bool says(std::string_view what) const { return all().find(what) != std::string::npos; }
  std::string all() const { return console_.out_text + console_.err_text; }

  fs::path folder_ = fs::path(testing::TempDir()) / fmt::format("servoctl-long-id-{}", ::getpid());
  RecordingConsole console_;
  std::unique_ptr<Shell> shell_;
};

TEST_F(LongId, IsWatchedSampledSentTakenAndDecoded) {
  use("sim:cia402@1", "cia402");
  ASSERT_EQ(run("pdo map TPDO1 statusword --cob-id 0x18ABCDEF --type 255 --event 10ms --yes"), 0) << all();
  ASSERT_EQ(run("pdo map RPDO1 target_velocity --cob-id 0x1ABCDE01 --type 255 --yes"), 0) << all();
  ASSERT_EQ(run("nmt start"), 0) << all();
  EXPECT_EQ(run("pdo watch TPDO1 --for 100ms"), 0) << all();
  EXPECT_TRUE(says("Statusword 0x")) << all();
  EXPECT_EQ(run("monitor --for 50ms --ask"), 0) << all();
  EXPECT_TRUE(says("TPDO1 Statusword 0x")) << all();
  EXPECT_EQ(run("watch statusword --for 100ms --json"), 0) << all();
  EXPECT_TRUE(says("\"by\":\"pdo\"") || says("pdo")) << all();
  EXPECT_EQ(run("pdo send RPDO1 1234 --yes"), 0) << all();
  EXPECT_TRUE(says("1ABCDE01#D2040000")) << all();
  EXPECT_EQ(run("read target_velocity --json"), 0) << all();
  EXPECT_TRUE(says("\"raw\":1234")) << all();
  EXPECT_EQ(run("decode " + (folder_ / "trace.log").string()), 0) << all();
  EXPECT_TRUE(says("TPDO1 Statusword 0x")) << all();
  EXPECT_TRUE(says("RPDO1 Target velocity 1234")) << all();
  EXPECT_FALSE(says("29-bit identifier")) << all();
}

TEST_F(LongId, IsRefusedWhereTheFamilyHasElevenBits) {
  for (const std::string family : {"gsd600", "dm", "da200", "ts"}) {
    SCOPED_TRACE(family);
    use("sim:" + family + "@1", family);
    EXPECT_EQ(run("pdo map TPDO1 statusword --cob-id 0x18ABCDEF --yes"), 2) << all();
  }
}

TEST_F(LongId, IsLeftOutOfAReplayAndTold) {
  use("sim:gsd600@1", "gsd600");
  std::ofstream(folder_ / "mixed.log") << "(1.000000) can0 601#4000100000000000\n(1.1) can0 18ABCDEF#3702\n";
  EXPECT_EQ(run("replay " + (folder_ / "mixed.log").string() + " --yes"), 0) << all();
  EXPECT_TRUE(says("1 frame with a 29-bit identifier is left out")) << all();
  std::ofstream(folder_ / "timeless.log") << "  can0  601   [8]  40 00 10 00 00 00 00 00\n"
                                             "  can0  601   [8]  40 18 10 01 00 00 00 00\n";
  EXPECT_EQ(run("replay " + (folder_ / "timeless.log").string() + " --yes"), 2) << all();
  EXPECT_TRUE(says("has no times")) << all();
  EXPECT_EQ(run("decode " + (folder_ / "timeless.log").string()), 0) << all();
}

TEST_F(LongId, ASimulatedDriveMayComeFromAFileOfAnyCase) {
  fs::create_directories(folder_ / "Lab");
  fs::copy_file(fs::path(source_dir()) / "tests/cli/data/node.eds", folder_ / "Lab/Node.EDS");
  use("sim:" + (folder_ / "Lab/Node.EDS").string() + "@1", {});
  EXPECT_EQ(run("scan"), 0) << all();
  use("sim:GSD600@1", {});
  EXPECT_EQ(run("scan"), 0) << all();
}

}  // namespace
}  // namespace servoctl::cli
