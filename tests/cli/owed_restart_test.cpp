// Values that a drive has stored and goes by after its next restart: kept until that is seen, and shown.
#include "show/owed_restart.hpp"

#include <fstream>

#include "axis_lines.hpp"
#include "show/bus_name.hpp"

namespace servoctl::cli {
namespace {

class OwedRestart : public AxisLines {
 protected:
  OwedRestart() { begin(); }
  /// A program of its own, with the folder for state of those before it.
  void begin() {
    shell.reset();
    Shell::Options options;
    options.drive_folders = {fs::path(source_dir()) / "eds"};
    options.clock = sim::SimBus::Clock::virtual_time;
    options.state_folder = folder / "state";
    fs::create_directories(options.state_folder);
    shell = std::make_unique<Shell>(console, options);
    shell->stay_open(true);
  }
  bool owes(std::string_view place) {
    (void)run(fmt::format("status {} --json", place));
    return says(R"("restart_owed":[{)") && says("in force after a restart");
  }
};

constexpr const char* kDrive = "-n 1 -d gsd600 -b sim:gsd600@1";

TEST_F(OwedRestart, AWriteThatWaitsIsShownUntilTheRestartIsSeen) {
  ASSERT_EQ(run(fmt::format("param set Pn0601=0 {}", kDrive)), 0) << all();
  EXPECT_EQ(run(fmt::format("status {}", kDrive)), 0) << all();
  EXPECT_TRUE(says("written, in force after a restart, which may lose it unless it is stored first"))
      << all();
  EXPECT_TRUE(says("Pn0601 = 0 No (1 Yes in force)")) << all();
  EXPECT_EQ(run(fmt::format("store --yes {}", kDrive)), 0) << all();
  EXPECT_EQ(run(fmt::format("status {}", kDrive)), 0) << all();
  EXPECT_TRUE(says("node 1: stored, in force after a restart: Pn0601 = 0 No (1 Yes in force)")) << all();
  EXPECT_EQ(run(fmt::format("nmt reset-comm --wait --yes {}", kDrive)), 0) << all();
  EXPECT_TRUE(owes(kDrive)) << "a reset of its communication alone is no restart: " << all();
  EXPECT_EQ(run(fmt::format("nmt reset --wait --yes {}", kDrive)), 0) << all();
  EXPECT_FALSE(owes(kDrive)) << all();
}

TEST_F(OwedRestart, IsNamedWhereTheDriveDoesNotObeyWithoutIt) {
  for (const auto& [family, set] :
       {std::pair{"da200", "param set P0.03=7"}, std::pair{"ts", "param set Fn_00=20 --unlock --keep"}}) {
    const auto place = fmt::format("-n 1 -d {0} -b sim:{0}@1", family);
    ASSERT_EQ(run(fmt::format("{} {}", set, place)), 0) << all();
    EXPECT_NE(run(fmt::format("enable --yes {}", place)), 0) << all();
    EXPECT_TRUE(says("waits for a restart")) << all();
    EXPECT_TRUE(says("hint: restart the drive")) << all();
    EXPECT_FALSE(says("hint: `nmt start")) << all();
  }
}

TEST_F(OwedRestart, TheLineThatIsNamedMakesTheDriveObey) {
  for (const auto* family : {"da200", "ts"}) {
    const auto bus = fmt::format("sim:{0}@1?state={1}/{0}", family, folder.string());
    const auto place = fmt::format("-n 1 -d {} -b {}", family, bus);
    EXPECT_NE(run(fmt::format("enable --yes {}", place)), 0) << all();
    const auto hint = all();
    const auto at = hint.find("`param set ");
    ASSERT_NE(at, std::string::npos) << hint;
    const auto line = hint.substr(at + 1, hint.find(" -n 1", at) - at - 1);
    const auto options =
        std::string(hint.find("--unlock --keep") != std::string::npos ? " --unlock --keep" : "");
    begin();
    ASSERT_EQ(run(fmt::format("{}{} {}", line, options, place)), 0) << all();
    begin();  // The simulated drive starts anew with it.
    EXPECT_EQ(run(fmt::format("enable --yes {}", place)), 0) << all();
    EXPECT_EQ(run(fmt::format("disable {}", place)), 0) << all();
  }
}

TEST_F(OwedRestart, OverModbusInfoShowsItAndEndsIt) {
  constexpr const char* kModbus = "-n 1 -d ts -b modbus:sim:ts@1";
  ASSERT_EQ(run(fmt::format("param set Fn_00=20 --unlock --keep {}", kModbus)), 0) << all();
  EXPECT_EQ(run(fmt::format("info {}", kModbus)), 0) << all();
  EXPECT_TRUE(says("node 1: stored, in force after a restart: Fn_00 = 20")) << all();
  EXPECT_TRUE(says("`info --restarted -n 1")) << all();
  EXPECT_EQ(run(fmt::format("info --restarted --read-only {}", kModbus)), 8) << all();
  EXPECT_EQ(run(fmt::format("info --restarted {}", kModbus)), 0) << all();
  EXPECT_EQ(run(fmt::format("info {}", kModbus)), 0) << all();
  EXPECT_FALSE(says("in force after a restart")) << all();
}

TEST_F(OwedRestart, TheOldValueWrittenAgainEndsIt) {
  ASSERT_EQ(run(fmt::format("param set Pn0601=0 {}", kDrive)), 0) << all();
  EXPECT_TRUE(owes(kDrive)) << all();
  ASSERT_EQ(run(fmt::format("param set Pn0601=0 {}", kDrive)), 0) << all();
  EXPECT_TRUE(owes(kDrive)) << all();
  ASSERT_EQ(run(fmt::format("write 0x2003:2 1 {}", kDrive)), 0) << all();
  EXPECT_FALSE(owes(kDrive)) << all();
  ASSERT_EQ(run(fmt::format("param set Pn0601=1 {}", kDrive)), 0) << all();
  EXPECT_FALSE(owes(kDrive)) << "what it held already waits for nothing: " << all();
}

TEST_F(OwedRestart, TheCautionOfWhatTheDriveGoesByStays) {
  ASSERT_EQ(run(fmt::format("param set Pn0601=0 {}", kDrive)), 0) << all();
  (void)run(fmt::format("jog 10rpm --for 100ms --turn 131072 --dry-run {}", kDrive));
  (void)run(fmt::format("enable --yes {}", kDrive));
  EXPECT_TRUE(says("written, in force after a restart: Pn0601 = 0 No (1 Yes in force)")) << all();
  EXPECT_TRUE(says("a wired emergency stop has no effect")) << all();
  EXPECT_EQ(run(fmt::format("disable {}", kDrive)), 0) << all();
  EXPECT_EQ(run(fmt::format("nmt reset --wait --yes {}", kDrive)), 0) << all();
  (void)run(fmt::format("enable --yes {}", kDrive));
  EXPECT_FALSE(says("in force after a restart")) << all();
}

TEST_F(OwedRestart, NothingMovesByUnitsThatAreNotInForce) {
  ASSERT_EQ(run(fmt::format("param set Pn0456=0 Pn0457=23 {}", kDrive)), 0) << all();
  EXPECT_EQ(run(fmt::format("jog 10rpm --for 100ms --yes {}", kDrive)), 8) << all();
  EXPECT_TRUE(
      says("what a turn of the motor is, is not known: written, in force after a restart: Pn0456 = 0"))
      << all();
  EXPECT_EQ(run(fmt::format("nmt reset --wait --yes {}", kDrive)), 0) << all();
  (void)run(fmt::format("jog 10rpm --for 100ms --yes {}", kDrive));
  EXPECT_FALSE(says("in force after a restart")) << all();
}

TEST_F(OwedRestart, OfADriveThatNeedsItsPowerOffIsNotEndedByAnNmtReset) {
  constexpr const char* kTs = "-n 1 -d ts -b sim:ts@1";
  ASSERT_EQ(run(fmt::format("write 0x2000 20 --unlock {}", kTs)), 0) << all();
  EXPECT_TRUE(owes(kTs) && says("which may lose it unless it is stored first")) << all();
  ASSERT_EQ(run(fmt::format("param set Fn_00=20 --unlock --keep {}", kTs)), 0) << all();
  EXPECT_TRUE(owes(kTs) && says("stored, in force after a restart")) << all();
  ASSERT_EQ(run(fmt::format("nmt reset --wait --yes {}", kTs)), 0) << all();
  EXPECT_TRUE(owes(kTs)) << all();
  EXPECT_TRUE(says("switch it off and on")) << all();
  EXPECT_TRUE(owes("-n 1 -b sim:ts@1") && says("switch it off and on")) << "without its family: " << all();
}

TEST_F(OwedRestart, ACabinetThatSaysTheUnitsOfAfterTheRestartMovesNothingBeforeIt) {
  shell->defaults().cabinet = folder / "cabinet.toml";
  write(
      "[bus.main]\nurl = \"sim:gsd600@1\"\n[axis.lift]\nbus = \"main\"\nnode = 1\nfamily = \"gsd600\"\n"
      "turn = 8388608\nparameters = { Pn0456 = 0, Pn0457 = 23 }\n");
  ASSERT_EQ(run("cabinet apply --yes"), 0) << all();
  EXPECT_EQ(run("jog lift 10rpm --for 100ms --yes"), 8) << all();
  EXPECT_TRUE(says("what a turn of the motor is, is not known")) << all();
}

/// A restart may have gone by unseen.
TEST_F(OwedRestart, WhatIsKeptAddsCautionsAndTakesNoneAway) {
  const show::OwedRestartFile file(folder / "state", "sim:gsd600@1", 1);
  ASSERT_EQ(run(fmt::format("param set Pn0603=0 --keep {}", kDrive)), 0) << all();
  ASSERT_EQ(run(fmt::format("nmt reset --wait --yes {}", kDrive)), 0) << all();
  ASSERT_EQ(run(fmt::format("param set Pn0603=3 {}", kDrive)), 0) << all();
  ASSERT_TRUE(owes(kDrive)) << all();
  EXPECT_EQ(run(fmt::format("home 17 --speed 60rpm --turn 131072 --limit 100rpm --yes {}", kDrive)), 8)
      << all();
  EXPECT_TRUE(says("which the drive ignores: Pn0603 = 3")) << all();
}

TEST_F(OwedRestart, WhatAnotherProgramHasWrittenStays) {
  const show::OwedRestartFile file(folder / "state", "sim:gsd600@1", 1);
  ASSERT_EQ(run(fmt::format("param set Pn0601=0 {}", kDrive)), 0) << all();
  auto kept = file.read();
  ASSERT_TRUE(kept && *kept);
  (*kept)->values.push_back({{0x2003, 4}, {}, Bytes{3, 0}});
  ASSERT_TRUE(file.write(**kept));
  ASSERT_EQ(run(fmt::format("param set Pn0011=1 {}", kDrive)), 0) << all();
  kept = file.read();
  ASSERT_TRUE(kept && *kept);
  EXPECT_EQ((*kept)->values.size(), 3U);
}

TEST_F(OwedRestart, AResetOfAllNodesIsHeard) {
  ASSERT_EQ(run(fmt::format("param set Pn0601=0 {}", kDrive)), 0) << all();
  EXPECT_EQ(run("nmt reset -n all --yes -b sim:gsd600@1"), 0) << all();
  EXPECT_FALSE(owes(kDrive)) << all();
}

TEST_F(OwedRestart, ThatCannotBeReadIsTold) {
  std::ofstream(folder / "state" /
                (std::string("restart-") + show::bus_name("sim:gsd600@1") + "-node-1.json"))
      << "{";
  (void)run(fmt::format("status {}", kDrive));
  EXPECT_TRUE(says("node 1: what waits for a restart is not known")) << all();
}

TEST_F(OwedRestart, NothingIsForgottenUnderReadOnly) {
  ASSERT_EQ(run(fmt::format("param set Pn0601=0 {}", kDrive)), 0) << all();
  EXPECT_EQ(run(fmt::format("status --restarted --read-only {}", kDrive)), 8) << all();
  EXPECT_EQ(run(fmt::format("status --restarted --dry-run {}", kDrive)), 0) << all();
  EXPECT_TRUE(owes(kDrive)) << all();
}

TEST_F(OwedRestart, ACabinetSaysThatTheRestartIsToCome) {
  shell->defaults().cabinet = folder / "cabinet.toml";
  write(
      "[bus.main]\nurl = \"sim:gsd600@1\"\n[axis.lift]\nbus = \"main\"\nnode = 1\nfamily = \"gsd600\"\n"
      "parameters = { Pn0601 = 0 }\n");
  ASSERT_EQ(run("cabinet apply --yes"), 0) << all();
  EXPECT_TRUE(says("needs a restart (Pn0601)")) << all();
  EXPECT_EQ(run("cabinet plan"), 1) << all();
  EXPECT_TRUE(says("nothing to write; needs a restart (Pn0601)")) << all();
  EXPECT_EQ(run("cabinet plan --json"), 1) << all();
  EXPECT_TRUE(says(R"("needs":[{"need":"restart","parameters":["Pn0601"]}])")) << all();
  EXPECT_EQ(run("cabinet show"), 0) << all();
  EXPECT_TRUE(says("0 restart")) << all();
  EXPECT_EQ(run("cabinet show --json"), 0) << all();
  EXPECT_TRUE(says(R"("restart_owed":["Pn0601"])")) << all();
  EXPECT_EQ(run("nmt reset lift --wait --yes"), 0) << all();
  EXPECT_EQ(run("cabinet plan"), 0) << all();
  EXPECT_TRUE(says("nothing to do")) << all();
}

TEST_F(OwedRestart, OfARestoreAndOfABackupInLinesToo) {
  const auto file = (folder / "values.json").string();
  ASSERT_EQ(run(fmt::format("backup {} {}", file, kDrive)), 0) << all();
  ASSERT_EQ(run(fmt::format("param set Pn0601=0 {}", kDrive)), 0) << all();
  ASSERT_EQ(run(fmt::format("nmt reset --wait --yes {}", kDrive)), 0) << all();
  ASSERT_FALSE(owes(kDrive)) << all();
  ASSERT_EQ(run(fmt::format("param set Pn0601=0 --keep {}", kDrive)), 0) << all();
  ASSERT_EQ(run(fmt::format("nmt reset --wait --yes {}", kDrive)), 0) << all();
  ASSERT_EQ(run(fmt::format("restore {} --yes {}", file, kDrive)), 0) << all();
  EXPECT_TRUE(owes(kDrive)) << all();
  EXPECT_EQ(run(fmt::format("status --restarted {}", kDrive)), 0) << all();
  EXPECT_FALSE(owes(kDrive)) << all();
}

/// What a new node-ID and bitrate are of each family, and what writes them.
struct AddressLine {
  const char* family;
  const char* line;
  const char* name;
};

TEST_F(OwedRestart, ANewNodeIdAndBitrateWaitAsOtherValuesDo) {
  for (const AddressLine one : {AddressLine{"gsd600", "param set Pn0049=5", "Pn0049"},
                                {"gsd600", "param set Pn0048=6", "Pn0048"},
                                {"da200", "param set P4.05=5", "P4.05"},
                                {"da200", "param set P4.02=2", "P4.02"},
                                {"ts", "param set Fn_9A=5 --unlock", "Fn_9A"},
                                {"ts", "param set Fn_9C=250 --unlock", "Fn_9C"},
                                {"dm", "write 0x2003:1 5", "0x2003:1"},
                                {"dm", "write 0x2003:2 1", "0x2003:2"}}) {
    fs::remove_all(folder / "state");
    begin();
    const auto place = fmt::format("-n 1 -d {0} -b sim:{0}@1", one.family);
    ASSERT_EQ(run(fmt::format("{} --yes {}", one.line, place)), 0) << one.name << all();
    EXPECT_EQ(run(fmt::format("status {}", place)), 0) << one.name << all();
    EXPECT_TRUE(says("in force after a restart") && says(one.name)) << one.name << all();
    EXPECT_EQ(run(fmt::format("info {}", place)), 0) << one.name << all();
    EXPECT_TRUE(says("in force after a restart") && says(one.name)) << one.name << all();
  }
}

TEST_F(OwedRestart, ANewNodeIdIsInForceWhereTheDriveAnswersWithIt) {
  const show::OwedRestartFile file(folder / "state", "sim:gsd600@1", 1);
  ASSERT_EQ(run(fmt::format("param set Pn0049=5 --keep --yes {}", kDrive)), 0) << all();
  ASSERT_TRUE(file.is_there());
  (void)run(fmt::format("nmt reset --yes {}", kDrive));
  EXPECT_FALSE(file.is_there()) << all();
  EXPECT_FALSE(owes("-n 5 -d gsd600 -b sim:gsd600@1")) << all();
}

/// Every line that hears the drive at its new node-ID, or not at its old one, ends it: a simulated drive
/// starts with each line. OwedRestartKept has those that nobody heard start.
TEST_F(OwedRestart, AStartAtTheNewNodeIdIsItsRestart) {
  constexpr const char* kBus = "sim:gsd600@5";
  const show::OwedRestartFile file(folder / "state", kBus, 1);
  session::Identity drive;
  drive.node = 1;
  drive.device_type = 0x0002'0192;
  const show::OwedRestart owed{.identity = drive,
                               .values = {{{0x2000, 0x32}, Bytes{1, 0}, Bytes{5, 0}, true}},
                               .node_id = ObjectAddress{0x2000, 0x32}};
  for (const auto* line : {"status -n 1 -d gsd600", "status -n 5 -d gsd600", "read 0x6041 -n 5"}) {
    ASSERT_TRUE(file.write(owed));
    begin();
    (void)run(fmt::format("{} -b {}", line, kBus));
    EXPECT_FALSE(file.is_there()) << line << all();
  }
}

/// A stopped node is silent as well, and another drive of the kind may have the node-ID that waits.
TEST_F(OwedRestart, SilenceIsNoRestart) {
  constexpr const char* kTwo = "-d gsd600 -b sim:gsd600@1,gsd600@2";
  ASSERT_EQ(run(fmt::format("param set Pn0601=0 --yes -n 1 {}", kTwo)), 0) << all();
  ASSERT_EQ(run(fmt::format("param set Pn0049=2 --yes -n 1 {}", kTwo)), 0) << all();
  (void)run(fmt::format("nmt stop -n 1 {}", kTwo));
  (void)run(fmt::format("status -n 1 {}", kTwo));
  (void)run(fmt::format("nmt preop -n 1 {}", kTwo));
  EXPECT_TRUE(owes(fmt::format("-n 1 {}", kTwo))) << all();
}

TEST_F(OwedRestart, ANewNodeIdThatNobodyAnswersWithStillWaits) {
  constexpr const char* kBus = "sim:gsd600@7";
  const show::OwedRestartFile file(folder / "state", kBus, 1);
  session::Identity drive;
  drive.node = 1;
  drive.device_type = 0x0002'0192;
  ASSERT_TRUE(file.write({.identity = drive,
                          .values = {{{0x2000, 0x32}, Bytes{1, 0}, Bytes{5, 0}, true}},
                          .node_id = ObjectAddress{0x2000, 0x32}}));
  begin();
  (void)run(fmt::format("status -n 1 -d gsd600 -b {}", kBus));
  (void)run(fmt::format("status -n 7 -d gsd600 -b {}", kBus));
  EXPECT_TRUE(file.is_there()) << all();
}

TEST_F(OwedRestart, InfoHasItAsAFieldAsStatusHas) {
  for (const auto& [set, place] :
       {std::pair{"param set Pn0601=0", "-n 1 -d gsd600 -b sim:gsd600@1"},
        std::pair{"param set Fn_00=20 --unlock", "-n 1 -d ts -b modbus:sim:ts@1"}}) {
    EXPECT_EQ(run(fmt::format("info {} --json", place)), 0) << all();
    EXPECT_FALSE(says(R"("restart_owed")")) << all();
    ASSERT_EQ(run(fmt::format("{} --yes {}", set, place)), 0) << all();
    EXPECT_EQ(run(fmt::format("info {} --json", place)), 0) << all();
    EXPECT_TRUE(says(R"("restart_owed":[{"index":)")) << all();
  }
}

TEST_F(OwedRestart, AWriteWithoutTheFamilyIsJudgedByTheIdentity) {
  ASSERT_EQ(run("write 0x2003:2 0 --type u16 -n 1 -b sim:gsd600@1"), 0) << all();
  EXPECT_TRUE(says("node 1: written, in force after a restart")) << all();
  EXPECT_TRUE(owes(kDrive)) << all();
  EXPECT_EQ(run("nmt reset --yes -n 1 -b sim:gsd600@1"), 0) << all();
  ASSERT_EQ(run("write 0x2000:7 1 --type u16 -n 1 -b sim:gsd600@1"), 0) << all();
  EXPECT_FALSE(says("restart")) << "it acts at once: " << all();
}

TEST_F(OwedRestart, AWriteToADriveOfTheGenericFamilyIsJudgedByTheIdentity) {
  constexpr const char* kPlace = "-n 1 -d cia402 -b sim:gsd600@1";
  ASSERT_EQ(run(fmt::format("read 0x6041 {}", kPlace)), 0) << all();
  ASSERT_EQ(run(fmt::format("write 0x2003:2 0 --type u16 {}", kPlace)), 0) << all();
  EXPECT_TRUE(says("node 1: written, in force after a restart")) << all();
  EXPECT_TRUE(owes(kDrive)) << all();
}

TEST_F(OwedRestart, AnotherDriveAtTheNodeOwesNothing) {
  const show::OwedRestartFile file(folder / "state", "sim:gsd600@1", 1);
  session::Identity other;
  other.node = 1;
  other.serial = 4711;
  ASSERT_TRUE(file.write({other, {{{0x2003, 2}, Bytes{1, 0}, Bytes{0, 0}}}, false}));
  const auto read = file.read();
  ASSERT_TRUE(read && *read);
  EXPECT_EQ((*read)->values.front().in_force, (Bytes{1, 0}));
  EXPECT_FALSE(owes(kDrive)) << all();
}

}  // namespace
}  // namespace servoctl::cli
