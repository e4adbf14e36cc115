// The family is asked once: what is remembered of a drive, offered, and forgotten when it is another drive.
#include <gtest/gtest.h>

#include <unistd.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "../source_dir.hpp"
#include "cli/line_runner.hpp"
#include "cli/shell.hpp"
#include "recording_console.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;

class KnownFamily : public testing::Test {
 protected:
  KnownFamily() : folder(fs::temp_directory_path() / ("servoctl-known-" + std::to_string(::getpid()))) {
    fs::create_directories(folder / "state");
    options.drive_folders = {fs::path(source_dir()) / "eds"};
    options.clock = sim::SimBus::Clock::virtual_time;
    options.state_folder = folder / "state";
    options.defaults.bus = "sim:gsd600@1,da200@2,gsd600@3";
    options.defaults.yes = true;
  }
  ~KnownFamily() override { fs::remove_all(folder); }

  /// As another process would, later.
  int run(std::string_view line) {
    console.out_text.clear();
    console.err_text.clear();
    return LineRunner(*std::make_unique<Shell>(console, options)).run(line);
  }
  std::string all() const { return console.out_text + console.err_text; }
  bool says(std::string_view what) const { return all().find(what) != std::string::npos; }
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder / "state"), fs::directory_iterator()));
  }
  fs::path only_file() const { return fs::directory_iterator(folder / "state")->path(); }
  void change_file(std::string_view from, std::string_view to) const {
    std::stringstream text;
    text << std::ifstream(only_file()).rdbuf();
    auto changed = text.str();
    const auto at = changed.find(from);
    ASSERT_NE(at, std::string::npos) << changed;
    std::ofstream(only_file()) << changed.replace(at, from.size(), to);
  }

  fs::path folder;
  Shell::Options options;
  RecordingConsole console;
};

TEST_F(KnownFamily, AReadGoesOnWithAGuessAndAWriteDoesNot) {
  EXPECT_EQ(run("param get Pn0202 -n 1"), 0) << all();
  EXPECT_TRUE(says("a guess, not proof; what writes or moves needs -d gsd600")) << all();
  EXPECT_EQ(files(), 0U) << "nobody said it";
  EXPECT_EQ(run("param set Pn0202 40Hz -n 1"), 2);
  EXPECT_TRUE(says("add -d gsd600")) << all();
  EXPECT_EQ(run("jog 30rpm --for 1s --turn 10000 -n 1"), 2);
  EXPECT_TRUE(says("needs the drive family")) << all();
}

TEST_F(KnownFamily, AGuessThatWasTakenForReadsIsNoneForWritesInTheSameSession) {
  Shell shell(console, options);
  shell.stay_open(true);
  EXPECT_EQ(LineRunner(shell).run("param get Pn0202 -n 1"), 0) << all();
  EXPECT_EQ(LineRunner(shell).run("param set Pn0202 40Hz -n 1"), 2) << all();
  EXPECT_EQ(LineRunner(shell).run("param set Pn0202 40Hz -n 1 -d gsd600"), 0) << all();
  EXPECT_EQ(LineRunner(shell).run("param set Pn0202 30Hz -n 1"), 0) << all();
}

constexpr std::string_view kSheetOfOwn =
    "[MandatoryObjects]\nSupportedObjects=2\n1=0x1000\n2=0x1018\n[OptionalObjects]\nSupportedObjects=4\n"
    "1=0x6040\n2=0x6041\n3=0x606C\n4=0x6081\n[ManufacturerObjects]\nSupportedObjects=1\n1=0x2001\n"
    "[1000]\nParameterName=Type\nObjectType=7\nDataType=7\nAccessType=ro\nDefaultValue=0x00020192\n"
    "[1018]\nParameterName=Identity\nObjectType=9\nSubNumber=2\n"
    "[1018sub0]\nParameterName=n\nObjectType=7\nDataType=5\nAccessType=ro\nDefaultValue=1\n"
    "[1018sub1]\nParameterName=v\nObjectType=7\nDataType=7\nAccessType=ro\nDefaultValue=0x1234\n"
    "[6040]\nParameterName=Controlword\nObjectType=7\nDataType=6\nAccessType=rw\n"
    "[6041]\nParameterName=Statusword\nObjectType=7\nDataType=6\nAccessType=ro\n"
    "[606C]\nParameterName=Velocity\nObjectType=7\nDataType=4\nAccessType=ro\n"
    "[6081]\nParameterName=Speed\nObjectType=7\nDataType=7\nAccessType=rw\n"
    "[2001]\nParameterName=Gain\nObjectType=7\nDataType=6\nAccessType=rw\nDefaultValue=4\n";

TEST_F(KnownFamily, AFamilyThatItsIdentityProvesIsNoGuess) {
  fs::create_directories(folder / "drives");
  const auto family = [&](const std::string& name, std::string_view certain) {
    std::ofstream(folder / "drives" / (name + ".toml"))
        << "format = 1\nfamily = \"" << name << "\"\nparent = \"cia402\"\n[identity]\ncertain = " << certain
        << "\nmatch = [{ object = \"0x1018:01\", value = 0x1234 }]\n";
    std::ofstream(folder / "drives" / (name + ".eds")) << kSheetOfOwn;
  };
  family("mine", "true");
  options.drive_folders = {folder / "drives", fs::path(source_dir()) / "eds"};
  options.defaults.bus = "sim:mine@1";
  EXPECT_EQ(run("read 0x2001 -n 1"), 0) << all();
  EXPECT_EQ(run("param set 0x2001 5 -n 1"), 0) << all();
  EXPECT_TRUE(says("node 1 is a mine: its identity proves it")) << all();
  EXPECT_FALSE(says("guess")) << all();
  EXPECT_EQ(files(), 0U) << "nobody said it";
  EXPECT_EQ(run("scan"), 0);
  EXPECT_FALSE(says("mine?")) << all();
  family("other", "false");
  EXPECT_EQ(run("param set 0x2001 5 -n 1"), 2) << "two that fit prove nothing: " << all();
  EXPECT_EQ(run("scan"), 0);
  EXPECT_TRUE(says("mine? or other?")) << all();
}

TEST_F(KnownFamily, AFamilyIsNotContradictedByThoseItDescendsFrom) {
  fs::create_directories(folder / "drives");
  std::ofstream(folder / "drives/mine.toml")
      << "format = 1\nfamily = \"mine\"\nparent = \"cia402\"\n[identity]\ncertain = true\n"
         "match = [{ object = \"0x1018:01\", value = 0x1234 }]\n";
  std::ofstream(folder / "drives/mine.eds") << kSheetOfOwn;
  std::ofstream(folder / "drives/child.toml") << "format = 1\nfamily = \"child\"\nparent = \"mine\"\n";
  std::ofstream(folder / "drives/grandchild.toml")
      << "format = 1\nfamily = \"grandchild\"\nparent = \"child\"\n";
  options.drive_folders = {folder / "drives", fs::path(source_dir()) / "eds"};
  options.defaults.bus = "sim:mine@1";
  for (const auto* family : {"child", "grandchild"}) {
    EXPECT_EQ(run(std::string("write 0x2001 5 -n 1 -d ") + family), 0) << all();
    for (const auto* line : {"read 0x606C -n 1 -d ", "write 0x6081 5 -n 1 -d "}) {
      EXPECT_EQ(run(std::string(line) + family), 0) << all();
      EXPECT_FALSE(says("inc/s")) << "CiA 402 alone has it: " << all();
    }
  }
}

TEST_F(KnownFamily, AFamilyOnCia402ShowsNoUnitThatNobodyStated) {
  fs::create_directories(folder / "drives");
  std::ofstream(folder / "drives/mine.toml") << "format = 1\nfamily = \"mine\"\nparent = \"cia402\"\n";
  std::ofstream(folder / "drives/mine.eds") << kSheetOfOwn;
  options.drive_folders = {folder / "drives", fs::path(source_dir()) / "eds"};
  options.defaults.bus = "sim:mine@1";
  for (const auto& family : {std::string("mine"), (folder / "drives/mine.eds").string()}) {
    EXPECT_EQ(run("read 0x606C -n 1 -d " + family), 0) << all();
    EXPECT_FALSE(says("inc/s")) << all();
  }
}

TEST_F(KnownFamily, AFamilyThatTheDriveContradictsIsToldAndNotRemembered) {
  EXPECT_EQ(run("param get P0.03 -n 1 -d da200"), 0) << all();
  EXPECT_TRUE(says("notice: node 1: not a da200: ")) << all();
  EXPECT_EQ(files(), 0U);
  Shell shell(console, options);
  shell.stay_open(true);
  EXPECT_EQ(LineRunner(shell).run("param get P0.03 -n 1 -d da200"), 0) << all();
  EXPECT_EQ(LineRunner(shell).run("param get Pn0202 -n 1"), 0) << all();
  EXPECT_TRUE(says("a guess, not proof")) << all();
}

/// A da200 takes a read of 1008h, which it does not have, as an alarm.
TEST_F(KnownFamily, RememberingADriveRaisesNoAccessAlarm) {
  options.defaults.trace = folder / "trace.log";
  EXPECT_EQ(run("param get P0.03 -n 2 -d da200"), 0) << all();
  EXPECT_EQ(files(), 1U) << all();
  std::stringstream frames;
  frames << std::ifstream(folder / "trace.log").rdbuf();
  EXPECT_NE(frames.str().find("582#"), std::string::npos) << frames.str();
  EXPECT_EQ(frames.str().find("082#"), std::string::npos) << frames.str();
}

TEST_F(KnownFamily, WhatWasSaidHoldsForTheDriveAndIsTold) {
  EXPECT_EQ(run("param get Pn0202 -n 1 -d gsd600"), 0) << all();
  EXPECT_FALSE(says("notice")) << all();
  EXPECT_EQ(files(), 1U);
  EXPECT_EQ(run("param set Pn0202 40Hz -n 1"), 0) << all();
  EXPECT_TRUE(says("node 1 is taken for gsd600, as said with -d at ")) << all();
  EXPECT_EQ(run("param set Pn0202 40Hz -n 3"), 2) << "of node 3 nobody said anything: " << all();
}

TEST_F(KnownFamily, ALineThatFailedSaysNothing) {
  EXPECT_NE(run("param set Pn0202 40Hz -n 2 -d gsd600"), 0);
  EXPECT_NE(run("param get Pn9999 -n 1 -d gsd600"), 0);
  EXPECT_EQ(run("param set Pn0202 40Hz -n 1 -d gsd600 --dry-run"), 0) << all();
  EXPECT_EQ(files(), 0U);
}

TEST_F(KnownFamily, IsForgottenWhenTheDriveIsAnother) {
  EXPECT_EQ(run("param get Pn0202 -n 1 -d gsd600"), 0) << all();
  change_file("\"serial\":0", "\"serial\":7");
  EXPECT_EQ(run("param set Pn0202 40Hz -n 1"), 2) << all();
  EXPECT_TRUE(says("its serial number (1018h:04) is another; that is forgotten")) << all();
  EXPECT_EQ(files(), 0U);
}

TEST_F(KnownFamily, ADamagedFileIsToldAndNotBelieved) {
  EXPECT_EQ(run("param get Pn0202 -n 1 -d gsd600"), 0) << all();
  std::ofstream(only_file()) << "{\"servoctl_drive\":1,\"node\":1,\"fam";
  EXPECT_EQ(run("param set Pn0202 40Hz -n 1"), 2) << all();
  EXPECT_TRUE(says("delete the file")) << all();
}

TEST_F(KnownFamily, NodesOfTwoFamiliesAreNotOneLine) {
  EXPECT_EQ(run("param get Pn0202 -n 1,2"), 2);
  EXPECT_TRUE(says("node 1 is taken for gsd600, node 2 for da200")) << all();
  EXPECT_EQ(run("param get Pn0202 -n 1,3"), 0) << all();
}

TEST_F(KnownFamily, CountsThatWereGivenAreOfferedAndNotTaken) {
  EXPECT_EQ(run("jog 30rpm --for 1s --turn 10000 -n 1 -d gsd600"), 0) << all();
  EXPECT_EQ(run("jog 30rpm --for 1s -n 1"), 2) << "no motion by a number of another day: " << all();
  EXPECT_TRUE(says("--turn 10000 was given for this drive at ")) << all();
  EXPECT_EQ(run("param get Pn0202 -n 1 -d gsd600"), 0);
  EXPECT_EQ(run("jog 30rpm --for 1s -n 1"), 2);
  EXPECT_TRUE(says("--turn 10000")) << "a line without --turn does not forget it: " << all();
  change_file("\"serial\":0", "\"serial\":7");
  EXPECT_EQ(run("jog 30rpm --for 1s -n 1 -d gsd600"), 2);
  EXPECT_FALSE(says("was given for this drive")) << all();
}

TEST_F(KnownFamily, AFileIsRememberedByItsWholePath) {
  const auto eds = fs::path(source_dir()) / "eds/vmmore/gsd600.eds";
  EXPECT_EQ(run("read 0x2001:3 -n 1 -d " + fs::relative(eds).string()), 0) << all();
  change_file(fs::canonical(eds).string(), "/nowhere.eds");
  EXPECT_NE(run("param get 0x2001:3 -n 1"), 0);
  EXPECT_TRUE(says("/nowhere.eds")) << all();
}

}  // namespace
}  // namespace servoctl::cli
