// What scan, nmt and read say of nodes that are there, stopped, silent or away.
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <unistd.h>
#include <fstream>

#include "../source_dir.hpp"
#include "cli/line_runner.hpp"
#include "cli/shell.hpp"
#include "recording_console.hpp"

namespace servoctl::cli {
namespace {

class NodeTruth : public testing::Test {
 protected:
  void use(const std::string& bus, const std::string& nodes = {}) {
    Shell::Options options;
    options.drive_folders = {std::filesystem::path(source_dir()) / "eds"};
    options.clock = sim::SimBus::Clock::virtual_time;
    options.defaults.bus = bus;
    options.defaults.nodes = nodes;
    shell = std::make_unique<Shell>(console, options);
  }
  int run(std::string_view line) {
    console.out_text.clear();
    console.err_text.clear();
    return LineRunner(*shell).run(line);
  }
  bool says(std::string_view what) const {
    return (console.out_text + console.err_text).find(what) != std::string::npos;
  }
  std::string all() const { return console.out_text + console.err_text; }

  RecordingConsole console;
  std::unique_ptr<Shell> shell;
};

constexpr const char* kFamilies[] = {"gsd600", "dm", "da200", "ts", "sv2", "cia402"};

TEST_F(NodeTruth, ScanLooksAtEveryNodeUnlessTheLineItselfNamesSome) {
  use("sim:dm@1,dm@2", "9");
  EXPECT_EQ(run("scan --json"), 0) << all();
  EXPECT_TRUE(says("\"node\":1") && says("\"node\":2")) << all();
  EXPECT_EQ(run("use 9"), 0) << all();
  EXPECT_EQ(run("scan --json"), 0) << all();
  EXPECT_TRUE(says("\"node\":1") && says("\"node\":2")) << all();
  EXPECT_EQ(run("scan --json -n 2"), 0) << all();
  EXPECT_TRUE(!says("\"node\":1") && says("\"node\":2")) << all();
  EXPECT_EQ(run("scan -n 9"), 4) << all();
}

TEST_F(NodeTruth, WatchTellsASilentDriveFromOneThatIsAwayAndOneThatFails) {
  for (const std::string family : kFamilies) {
    SCOPED_TRACE(family);
    // sv2 has no 1017h.
    const bool produces = family != "sv2";
    use("sim:" + family + "@1");
    EXPECT_EQ(run("nmt watch -n 1,9 --for 1s --json"), 1) << all();
    EXPECT_TRUE(says(R"("node":1,"alive":null)")) << "nobody knows: " << all();
    EXPECT_TRUE(says(R"("node":9,"alive":false)")) << all();
    EXPECT_EQ(run("nmt watch -n 1,9 --for 1s"), 1) << all();
    EXPECT_TRUE(says(produces ? "node 1: sends no heartbeat" : "it has no 1017h")) << all();
    EXPECT_TRUE(says("node 9: does not answer and sent nothing")) << all();
    EXPECT_FALSE(says("node 9: sends no heartbeat")) << all();
    EXPECT_EQ(run("nmt watch -n 9 --for 1s --guard 100ms"), 1) << all();
    EXPECT_TRUE(says("node 9: does not answer and sent nothing")) << all();
  }
}

TEST_F(NodeTruth, WatchHearsTheEmergencyOfADriveThatAnswersNothing) {
  use("sim:gsd600@1?silent=10s&fault=0xFF00@300ms");
  EXPECT_EQ(run("nmt reset -n 1 --yes"), 0) << all();
  EXPECT_EQ(run("nmt watch -n 1 --for 3s"), 1) << all();
  EXPECT_FALSE(says("never heard")) << all();
}

TEST_F(NodeTruth, WatchHearsEmergenciesUnderTheCanIdOf1014h) {
  const auto file = std::filesystem::temp_directory_path() / fmt::format("servoctl-emcy-{}", ::getpid());
  const std::pair<std::string, std::string> stored[] = {{"gsd600", "0x2000:6B F0000000"},  // Pn0106
                                                        {"dm", "0x1014:00 F1000000"},
                                                        {"ts", "0x1014:00 F1000000"},
                                                        {"cia402", "0x1014:00 F1000000"}};
  for (const auto& [family, cell] : stored) {
    SCOPED_TRACE(family);
    std::ofstream(file) << "# servoctl: memory of simulated drives, version 1\n1." << family << ' ' << cell
                        << '\n';
    use("sim:" + family + "@1?state=" + file.string() + "&fault=0x2310@500ms");
    (void)run("nmt watch -n 1 --for 1s");
    EXPECT_TRUE(says("node 1: EMCY 0x2310")) << all();
  }
  std::filesystem::remove(file);
}

TEST_F(NodeTruth, AnAddressOfEmergenciesThatWasWrittenIsKnown) {
  use("sim:cia402@1?fault=0x2310@500ms", "1");
  EXPECT_EQ(run("write 0x1014 0x80000081"), 0) << all();
  EXPECT_EQ(run("write 0x1014 0x1F1"), 0) << all();
  EXPECT_EQ(run("monitor --for 1s"), 0) << all();
  (void)run("fault show --json");
  EXPECT_TRUE(says(R"("emergencies":[{"code":8976)")) << all();
}

TEST_F(NodeTruth, AResetOfTheCommunicationSaysWhatIsGone) {
  for (const std::string family : kFamilies) {
    SCOPED_TRACE(family);
    use("sim:" + family + "@1", "1");
    EXPECT_EQ(run("nmt reset-comm --yes --wait"), 0) << all();
    EXPECT_TRUE(says("node 1: by CiA 301 1000h to 1FFFh now have their power-on values")) << all();
    EXPECT_FALSE(says("go back")) << all();
    for (const char* unseen : {"nmt reset-comm --yes", "nmt reset-comm --dry-run", "nmt reset-comm"}) {
      (void)run(unseen);
      EXPECT_TRUE(says("1000h to 1FFFh go back to their power-on values")) << all();
      EXPECT_TRUE(says("the watchdog")) << all();
      EXPECT_FALSE(says("are now")) << all();
    }
    EXPECT_EQ(run("nmt reset-comm --yes --wait -n 1,9"), 4) << all();
    EXPECT_TRUE(says("node 1: by CiA 301 1000h to 1FFFh now")) << all();
    EXPECT_FALSE(says("node 9: by CiA 301")) << all();
    EXPECT_TRUE(says("go back")) << all();
    EXPECT_EQ(run("nmt reset --yes --wait"), 0) << all();
    EXPECT_FALSE(says("1000h to 1FFFh")) << all();
  }
}

TEST_F(NodeTruth, ASyncPeriodThatTheDriveRefusesIsNotSent) {  // da200, line 145 of its manual
  use("sim:da200@1", "1");
  EXPECT_EQ(run("write 0x1006 999 -d da200"), 2) << all();
  EXPECT_TRUE(says("999 is out of range: 0, or at least 1000")) << all();
  EXPECT_TRUE(says("hint: 0 switches it off; the minimum 1000 is assumed")) << all();
  EXPECT_EQ(run("write 0x1006 0 -d da200"), 0) << all();
  EXPECT_EQ(run("write 0x1006 1000 -d da200"), 0) << all();
}

TEST_F(NodeTruth, ATypeForRemoteFramesIsRefusedWhereBit30ForbidsThem) {
  use("sim:gsd600@1", "1");
  EXPECT_EQ(run("pdo map TPDO1 0x6041 --type 253 -y -d gsd600"), 2) << all();
  EXPECT_TRUE(says("does not support transmission type 253")) << all();  // Line 1664 of its manual: reserved.
  EXPECT_TRUE(says("hint: 0 to 240 by SYNC, 254 and 255 by event")) << all();
  use("sim:cia402@1", "1");
  EXPECT_EQ(run("write 0x1800:1 0xC0000181 -d cia402"), 0) << all();
  EXPECT_EQ(run("pdo map TPDO1 0x6041 --type 253 -y -d cia402"), 2) << all();
  EXPECT_TRUE(says("which bit 30 of its COB-ID forbids")) << all();
  EXPECT_TRUE(says("hint: 0 to 240 by SYNC, 254 and 255 by event")) << all();
  EXPECT_EQ(run("pdo map TPDO2 0x6041 --type 250 -y -d cia402"), 2) << all();
  EXPECT_TRUE(says("252 and 253 by remote frame, 254 and 255 by event")) << all();
  use("sim:dm@1", "1");
  EXPECT_EQ(run("pdo map TPDO1 0x6041 --type 250 -y -d dm"), 2) << all();
  EXPECT_TRUE(says("hint: 0 to 240 by SYNC, 254 and 255 by event")) << all();
  use("sim:da200@1", "1");
  EXPECT_EQ(run("pdo map TPDO1 0x6041 --type 255 -y -d da200"), 2) << all();
  EXPECT_TRUE(says(", 254 by event")) << all();
  use("sim:ts@1", "1");
  EXPECT_EQ(run("pdo map TPDO1 0x6041 --type 253 -y -d ts"), 0) << all();
  EXPECT_EQ(run("nmt start"), 0) << all();
  EXPECT_EQ(run("pdo watch TPDO1 --for 100ms -d ts"), 0) << all();
  EXPECT_TRUE(says("are sent only on a remote frame")) << all();
}

TEST_F(NodeTruth, ANodeThatWasStoppedIsConfirmedByItsHeartbeat) {
  for (const std::string family : kFamilies) {
    if (family == "sv2") continue;  // It has neither 1017h nor NMT by heartbeat.
    SCOPED_TRACE(family);
    use("sim:" + family + "@1", "1");
    ASSERT_EQ(run("write 0x1017 100 --type u16"), 0) << all();
    for (const std::string command : {"start", "preop"}) {
      SCOPED_TRACE(command);
      ASSERT_EQ(run("nmt stop --wait"), 0) << all();
      EXPECT_EQ(run("read 0x1000"), 4) << all();
      EXPECT_TRUE(says("node 1 is stopped")) << all();
      EXPECT_TRUE(says("nmt preop -n 1")) << all();
      EXPECT_EQ(run("nmt " + command + " --wait"), 0) << all();
      EXPECT_TRUE(says(command == "start" ? "operational" : "pre-operational")) << all();
    }
  }
}

TEST_F(NodeTruth, ANodeWithoutHeartbeatIsNotWaitedFor) {
  use("sim:dm@1", "1");
  EXPECT_EQ(run("nmt start --wait"), 4) << all();
  EXPECT_TRUE(says("sends no heartbeat")) << all();
  EXPECT_EQ(run("read 0x1000 -n 9"), 4) << all();
  EXPECT_TRUE(says("a stopped node does not: `nmt preop -n 9`")) << all();
}

}  // namespace
}  // namespace servoctl::cli
