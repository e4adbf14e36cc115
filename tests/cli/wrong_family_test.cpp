// The whole registry with a family that the drive is not: nothing is written to it, except for the ways out.
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
#include "recording_console.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVendorFamilies[] = {"gsd600", "dm", "da200", "sv2", "ts"};

/// A line of each command that touches a drive; `%` stands for a folder of the test.
const std::map<std::string, std::string, std::less<>> kLines{
    {"backup", "backup %b.json"},
    {"clone", "clone --from 1 --to 2"},
    {"defaults", "defaults"},
    {"diff", "diff node:1 factory"},
    {"disable", "disable"},
    {"enable", "enable"},
    {"fault clear-history", "fault clear-history"},
    {"fault reset", "fault reset"},
    {"fault show", "fault show"},
    {"home", "home 1 --turn 10000"},
    {"info", "info"},
    {"jog", "jog 60rpm --turn 131072 --for 600ms"},
    {"mode", "mode 1"},
    {"monitor", "monitor --for 20ms"},
    {"move", "move 1rev --relative --turn 10000"},
    {"nmt preop", "nmt preop"},
    {"nmt reset", "nmt reset"},
    {"nmt reset-comm", "nmt reset-comm"},
    {"nmt start", "nmt start"},
    {"nmt stop", "nmt stop"},
    {"nmt watch", "nmt watch --for 20ms"},
    {"param get", "param get Pn0214"},
    {"param set", "param set Pn0214 450"},
    {"pdo apply", "pdo apply %missing.toml"},
    {"pdo clear", "pdo clear TPDO1"},
    {"pdo disable", "pdo disable TPDO1"},
    {"pdo enable", "pdo enable TPDO1"},
    {"pdo map", "pdo map TPDO1 0x6041"},
    {"pdo preset", "pdo preset pp"},
    {"pdo save", "pdo save %pdos.toml"},
    {"pdo send", "pdo send RPDO1 6"},
    {"pdo show", "pdo show"},
    {"pdo watch", "pdo watch TPDO1 --for 20ms"},
    {"quick-stop", "quick-stop"},
    {"read", "read 0x6041"},
    {"replay", "replay %recording.log"},
    {"report", "report %r.html"},
    {"restore", "restore %b.json"},
    {"scan", "scan"},
    {"scope", "scope 0x6041 --map --for 20ms"},
    {"status", "status"},
    {"store", "store"},
    {"sync once", "sync once"},
    {"sync start", "sync start 10ms --count 1"},
    {"sync stop", "sync stop"},
    {"test all", "test all 60rpm"},
    {"test comm", "test comm --count 5"},
    {"test home", "test home"},
    {"test io", "test io --for 20ms"},
    {"test jog", "test jog 60rpm"},
    {"torque", "torque 5% --for 60ms"},
    {"verify", "verify factory"},
    {"watch", "watch 0x6041 --for 20ms"},
    {"write", "write 0x6060 1"},
    {"units learn", "units learn"},
    {"units show", "units show"},
};

/// Commands that send nothing to a drive.
const std::set<std::string_view> kQuiet{
    "objects",   "param list", "param search", "param explain", "fault list", "decode",      "drives",
    "eds check", "run",        "sim",          "help",          "completion", "units forget"};

/// Refused on a read already: the answer would make sense for the family alone.
const std::set<std::string_view> kAnswers{"backup", "diff",    "info",       "report",
                                          "scope",  "test io", "units show", "verify"};
const std::set<std::string_view> kWaysOut{"disable", "quick-stop"};

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
    options.defaults.bus = "sim:" + drive + "@1," + drive + "@2";
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

TEST_F(WrongFamily, TheTableHasEveryCommand) {
  for (const auto* command : command::registry())
    EXPECT_TRUE(kLines.count(command->path) + kQuiet.count(command->path) == 1)
        << command->path << ": write here what it does with a family that the drive is not";
}

TEST_F(WrongFamily, WritesNothingByAnyCommand) {
  for (const std::string drive : kVendorFamilies)
    for (const std::string named : kVendorFamilies) {
      if (drive == named) continue;
      open(drive, named);
      for (const auto& [path, line] : kLines) {
        SCOPED_TRACE("-d " + named + " on " + drive + ": " + line);
        const auto* command = command::find_command(path);
        if (command->family == command::FamilyCheck::never && path != "info" && path != "test all") continue;
        const int code = run(line);
        const bool only_reads =
            !command->reads_without.empty() && line.find(command->reads_without) == std::string::npos;
        if (kAnswers.count(path) == 0 && (only_reads || command->effect < command::Effect::writes)) {
          EXPECT_NE(code, 8) << said;
          continue;
        }
        EXPECT_EQ(code, 8) << said;
        EXPECT_NE(said.find("node 1: not a " + named), std::string::npos) << said;
        EXPECT_NE(said.find("--force-family"), std::string::npos) << said;
      }
      close();
      EXPECT_GT(sent, 10);
      EXPECT_EQ(written, std::vector<std::string>{}) << "-d " << named << " on " << drive;
    }
}

TEST_F(WrongFamily, RefusesNoWayOut) {
  for (const auto& [path, line] : kLines) {
    const auto* command = command::find_command(path);
    if (command->family != command::FamilyCheck::never || path == "info" || path == "test all") continue;
    SCOPED_TRACE(line);
    EXPECT_NE(run(line, "da200", "gsd600"), 8) << said;
    if (kWaysOut.count(path) > 0) {
      EXPECT_FALSE(written.empty()) << said;
    }
  }
}

TEST_F(WrongFamily, RefusesWhatTheIssueNames) {
  EXPECT_EQ(run("jog 60rpm --turn 131072 --for 600ms", "da200", "gsd600"), 8);
  EXPECT_NE(said.find("its 0x1000:0 is 0x04020200, but gsd600 has 0x00020192"), std::string::npos) << said;
  EXPECT_NE(said.find("add -d da200"), std::string::npos) << said;
  EXPECT_EQ(run("jog 60rpm --turn 10000 --for 600ms", "gsd600", "da200"), 8);
  EXPECT_EQ(run("backup %b.json", "dm", "gsd600"), 8);
  EXPECT_FALSE(fs::exists(folder_ / "b.json"));
  for (const auto* line : {"store", "info", "report %r.html"})
    EXPECT_EQ(run(line, "dm", "gsd600"), 8) << line;
  EXPECT_FALSE(fs::exists(folder_ / "r.html"));
}

TEST_F(WrongFamily, IsRefusedInADryRunToo) {
  EXPECT_EQ(run("param set Pn0214 450", "da200", "gsd600", "--dry-run"), 8);
  EXPECT_EQ(run("write 0x6060 1", "da200", "gsd600", "--dry-run"), 8);
}

TEST_F(WrongFamily, GoesOnWhenItIsForcedAndSaysSo) {
  EXPECT_EQ(run("write 0x6060 1", "da200", "gsd600", "--force-family"), 0) << said;
  EXPECT_NE(said.find("node 1 is no gsd600"), std::string::npos) << said;
  EXPECT_EQ(written.size(), 1U);
  EXPECT_EQ(run("write 0x6060 1", "da200", "gsd600", "--yes"), 8) << said;
}

TEST_F(WrongFamily, TellsWhatProvesNothingAndKeepsSilentOverAProof) {
  EXPECT_EQ(run("write 0x6060 1", "ts", "cia402"), 0);
  EXPECT_NE(said.find("node 1: nothing proves that it is a cia402"), std::string::npos) << said;
  for (const std::string family : kVendorFamilies) {
    EXPECT_EQ(run("write 0x6060 1", family, family), 0) << said;
    EXPECT_EQ(said.find("proves"), std::string::npos) << said;
  }
}

TEST_F(WrongFamily, AsksAPlainReadForNothing) {
  EXPECT_EQ(run("read 0x6041", "da200", "gsd600", ""), 0) << said;
  EXPECT_EQ(sent, 1);
  EXPECT_EQ(said.find("is no"), std::string::npos);
}

TEST_F(WrongFamily, CostsFourReadsOnce) {
  open("da200", "da200");
  EXPECT_EQ(run("write 0x6060 1", ""), 0) << said;
  EXPECT_EQ(run("write 0x6060 3", ""), 0) << said;
  close();
  EXPECT_EQ(sent, 4 + 2);
}

class WrongFamilyPrompt : public testing::Test {
 protected:
  WrongFamilyPrompt() : shell_(console, options()) {}
  static Shell::Options options() {
    Shell::Options o;
    o.drive_folders = {fs::path(source_dir()) / "eds"};
    o.clock = sim::SimBus::Clock::virtual_time;
    o.defaults.bus = "sim:da200@1,gsd600@2,dm@3,ts@4";
    return o;
  }
  int run(std::string_view line) {
    console.out_text.clear();
    console.err_text.clear();
    return shell_.run(split_words(line).value());
  }
  bool told(std::string_view text) const { return console.err_text.find(text) != std::string::npos; }
  RecordingConsole console;
  Shell shell_;
};

TEST_F(WrongFamilyPrompt, TellsOnceASession) {
  EXPECT_EQ(run("write 0x6060 1 -n 4 -d cia402"), 0);
  EXPECT_TRUE(told("nothing proves that it is a cia402"));
  EXPECT_EQ(run("write 0x6060 3 -n 4 -d cia402"), 0);
  EXPECT_FALSE(told("proves")) << console.err_text;
  EXPECT_EQ(run("nmt reset -n 4 --yes --wait"), 0);
  EXPECT_EQ(run("write 0x6060 3 -n 4 -d cia402"), 0);
  EXPECT_TRUE(told("nothing proves that it is a cia402")) << "another may stand there after a restart";
}

TEST_F(WrongFamilyPrompt, TellsAReadWhatIsKnown) {
  EXPECT_EQ(run("read 0x6041 -n 1 -d gsd600"), 0);
  EXPECT_FALSE(told("is no"));
  EXPECT_EQ(run("write 0x6060 1 -n 1 -d gsd600"), 8);
  EXPECT_EQ(run("read 0x6041 -n 1 -d gsd600"), 0);
  EXPECT_TRUE(told("node 1 is no gsd600")) << console.err_text;
  EXPECT_EQ(run("disable -n 1 -d gsd600"), 0) << console.err_text;
}

TEST_F(WrongFamilyPrompt, RefusesAllWhenOneOfSeveralIsAnother) {
  EXPECT_EQ(run("write 0x6060 3 -n 2,3 -d gsd600"), 8);
  EXPECT_TRUE(told("node 3 is no gsd600")) << console.err_text;
  EXPECT_EQ(run("read 0x6060 -n 2 --json"), 0);
  EXPECT_EQ(console.out_text.find("\"value\":3"), std::string::npos) << console.out_text;
  EXPECT_EQ(run("clone --from 2 --to 3 -d gsd600 --yes"), 8);
  EXPECT_EQ(run("diff node:2 node:3 -d gsd600"), 8);
}

TEST_F(WrongFamilyPrompt, TellsThatANodeWhichIsNotThereDoesNotAnswer) {
  EXPECT_EQ(run("write 0x6060 1 -n 9 -d gsd600"), 4);
  EXPECT_EQ(run("backup nothing.json -n 9 -d gsd600"), 4);
  EXPECT_EQ(run("write 0x6060 1 -n 2,9 -d gsd600"), 4);
  EXPECT_TRUE(told("node 9 did not answer")) << console.err_text;
}

}  // namespace
}  // namespace servoctl::cli
