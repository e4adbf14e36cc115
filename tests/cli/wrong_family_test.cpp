// The whole registry with a family that the drive is not: nothing is written to it, except for the ways out.
#include "tests/cli/wrong_family_fixture.hpp"

namespace servoctl::cli {
namespace {

constexpr const char* kVendorFamilies[] = {"gsd600", "dm", "da200", "sv2", "ts"};

/// A line of each command that touches a drive; `%` stands for a folder of the test.
const std::map<std::string, std::string, std::less<>> kLines{
    {"address", "address 9"},
    {"backup", "backup %b.json"},
    {"clone", "clone --from 1 --to 2"},
    {"defaults", "defaults"},
    {"diff", "diff node:1 factory"},
    {"disable", "disable"},
    {"eds verify", "eds verify %missing.eds"},
    {"eds learn", "eds learn -o %learned.eds --range 6040-6041 --despite-alarms -y"},
    {"enable", "enable"},
    {"fault clear-history", "fault clear-history"},
    {"fault reset", "fault reset"},
    {"fault show", "fault show"},
    {"heartbeat consume", "heartbeat consume 2=300ms"},
    {"heartbeat set", "heartbeat set 100ms"},
    {"heartbeat show", "heartbeat show"},
    {"home", "home 1 --turn 10000"},
    {"info", "info"},
    {"jog", "jog 60rpm --turn 131072 --for 600ms"},
    {"lss inquire", "lss inquire --only"},
    {"lss select", "lss select --only"},
    {"lss scan", "lss scan --assign 9"},
    {"lss set-bitrate", "lss set-bitrate 500k --only"},
    {"lss set-node", "lss set-node 9 --only"},
    {"lss store", "lss store --only"},
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
    {"state init", "state init"},
    {"state op", "state op"},
    {"state preop", "state preop"},
    {"state safeop", "state safeop"},
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
    {"stop", "stop -n 1"},
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
    {"watchdog", "watchdog"},
    {"witness", "witness %w.json"},
    {"write", "write 0x6060 1"},
    {"units learn", "units learn"},
    {"units show", "units show"},
};

/// Commands that send nothing to a drive.
const std::set<std::string_view> kQuiet{
    "objects",  "param list",   "param search", "param explain", "fault list", "decode",
    "drives",   "drives check", "drives new",   "eds check",     "run",        "sim",
    "help",     "completion",   "units forget", "cabinet check", "bus status", "bus up",
    "bus down", "bus detect",   "doctor",       "gateway",       "explain",    "man"};

/// Held against the family that the cabinet file names, see tests/cabinet.
const std::set<std::string_view> kByFile{"cabinet init",   "cabinet show", "cabinet plan", "cabinet apply",
                                         "cabinet backup", "cabinet diff", "cabinet swap"};

/// Refused on a read already: the answer would make sense for the family alone.
const std::set<std::string_view> kAnswers{"backup",  "diff",       "info",   "report",  "scope",
                                          "test io", "units show", "verify", "watchdog"};
const std::set<std::string_view> kWaysOut{"disable", "quick-stop", "stop"};

TEST_F(WrongFamily, TheTableHasEveryCommand) {
  for (const auto* command : command::registry())
    EXPECT_TRUE(kLines.count(command->path) + kQuiet.count(command->path) + kByFile.count(command->path) == 1)
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
  EXPECT_NE(said.find("notice: node 1: not a gsd600"), std::string::npos) << said;
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

TEST_F(WrongFamily, CostsThreeReadsOnce) {
  open("da200", "da200");
  EXPECT_EQ(run("write 0x6060 1", ""), 0) << said;
  EXPECT_EQ(run("write 0x6060 3", ""), 0) << said;
  close();
  EXPECT_EQ(sent, 3 + 2) << "1000h, 1018h:01, 1018h:02; a da200 has no 1008h";
}

}  // namespace
}  // namespace servoctl::cli
