// Drives that raise an alarm when they are asked for an object that they do not have ([fault] object_alarm
// and sub_index_alarm): no command asks for one, with the family named or not.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>

#include "can/frame.hpp"
#include "command/command.hpp"
#include "command/registry.hpp"
#include "sample_lines.hpp"

namespace servoctl::cli {
namespace {

constexpr std::uint32_t kEmergency = 0x081;  ///< COB-ID of node 1 (CiA 301, 7.3.3).

/// Er26-1 or Er26-2: an EMCY with the panel's numbers 26 and 1 or 2 in bytes 3 and 4 (da200 336-339,
/// 1084-1085).
bool tells_access_alarm(const can::Frame& frame) {
  return !frame.remote && (frame.id == kEmergency || frame.id == kEmergency + 1) && frame.data[3] == 26 &&
         (frame.data[4] == 1 || frame.data[4] == 2);
}

std::string access_alarms(const std::vector<can::Frame>& frames) {
  std::string out;
  std::string asked;
  for (const auto& frame : frames) {
    if (frame.id == 0x601 || frame.id == 0x602) asked = can::to_string(frame);
    if (tells_access_alarm(frame)) out += asked + " -> " + can::to_string(frame) + "\n";
  }
  return out;
}

class AccessAlarm : public testing::Test {
 protected:
  std::string text() const { return lines.console.out_text + lines.console.err_text; }

  SampleLines lines{"da200"};
};

TEST_F(AccessAlarm, NoCommandRaisesOne) {
  std::size_t with_frames = 0;
  for (const auto* command : command::registry()) {
    const auto sample = kSampleLines.find(std::string(command->path));
    ASSERT_NE(sample, kSampleLines.end()) << "give '" << command->path << "' a sample line";
    for (const bool names_family : {true, false}) {
      lines.forget_drives();
      (void)lines.perform(sample->second, {}, names_family);
      EXPECT_EQ(access_alarms(lines.frames), "") << sample->second << (names_family ? " -d da200" : "");
      with_frames += lines.frames.empty() ? 0U : 1U;
    }
  }
  EXPECT_GT(with_frames, 80U) << "most of them speak to the drive";
}

TEST_F(AccessAlarm, NoLongerFormOfACommandRaisesOne) {
  for (const auto* line :
       {"scan --long", "scan --all", "info -n all", "status -n all", "monitor --ask --for 1s",
        "doctor --active", "nmt reset --wait -n 1 -y", "home 35 --turn 10000 -n 1 -y --verbose",
        "home -n 1 -y", "jog 60rpm --for 200ms -n 1 -y", "backup DIR/all.json -n 1 --all", "read 0x1018 -n 1",
        "param get -n 1", "read 0x603* -n 1 -d cia402", "watch 0x603F --for 100ms -n 1 -d cia402",
        "read statusword -n 1 -d cia402", "pdo show -n all", "cabinet show"})
    for (const bool names_family : {true, false}) {
      lines.forget_drives();
      (void)lines.perform(line, {}, names_family);
      EXPECT_EQ(access_alarms(lines.frames), "") << line << (names_family ? " -d da200" : "");
    }
}

TEST_F(AccessAlarm, NoneComesWithTheFileOfTheMaker) {
  const auto file = source_dir() + "/eds/invt/da200.eds";
  for (const auto* line : {"enable -n 1 -y", "jog 60rpm --for 200ms --turn 10000 -n 1 -y", "status -n 1"}) {
    lines.forget_drives();
    (void)lines.perform(fmt::format("{} -d {}", line, file), {}, false);
    EXPECT_EQ(access_alarms(lines.frames), "") << line;
  }
}

TEST_F(AccessAlarm, ADryRunShowsNoWriteThatIsNotSent) {
  EXPECT_EQ(lines.perform("write 0x603F 1 --type u16 -n 1 --dry-run"), 5) << text();
  EXPECT_NE(text().find("not sent: the data of da200 have no such object"), std::string::npos) << text();
  EXPECT_EQ(text().find("601#"), std::string::npos) << text();
}

TEST_F(AccessAlarm, AnObjectThatTheFamilyLacksIsReadAfterAQuestion) {
  for (const bool names_family : {true, false}) {
    EXPECT_EQ(lines.perform("read 0x603F -n 1", {}, names_family), 8);
    EXPECT_NE(
        text().find("Read 0x603F:0 of node 1? The data of da200 have no such object, and a request for it "
                    "raises the alarm Er26-1."),
        std::string::npos)
        << text();
    EXPECT_EQ(access_alarms(lines.frames), "");
  }
  EXPECT_EQ(lines.perform("read 0x1018:7 -n 1"), 8);
  EXPECT_NE(text().find("Er26-2"), std::string::npos) << text();
  EXPECT_EQ(lines.perform("read 0x603F -n 1 -y"), 5);
  EXPECT_NE(access_alarms(lines.frames), "") << "the simulated drive raises it";
  EXPECT_EQ(lines.perform("read 0x1018:7 -n 1 -y"), 5);
  EXPECT_NE(access_alarms(lines.frames), "");
}

TEST_F(AccessAlarm, AWriteOfAnObjectThatTheFamilyLacksIsNotSent) {
  EXPECT_NE(lines.perform("write 0x603F 1 --type u16 -n 1 -y"), 0);
  EXPECT_NE(
      text().find(
          "not sent: the data of da200 have no such object, and a request for it raises the alarm Er26-1"),
      std::string::npos)
      << text();
  EXPECT_EQ(access_alarms(lines.frames), "");
}

/// Scripts poll the statusword: its name asks for 1000h, and nothing else is asked.
TEST_F(AccessAlarm, WhatEveryDriveHasIsReadWithoutAskingWhoItIs) {
  const auto requests = [&](std::string_view line) {
    lines.forget_drives();
    EXPECT_EQ(lines.perform(std::string(line), {}, false), 0) << text();
    return std::count_if(lines.frames.begin(), lines.frames.end(),
                         [](const can::Frame& frame) { return frame.id == 0x601; });
  };
  EXPECT_EQ(requests("read 0x6041 -n 1"), 2);
  EXPECT_EQ(requests("read 0x6041 0x6061 -n 1"), 3);
  EXPECT_EQ(requests("read 0x6041 0x6064 -n 1"), 3 + 2) << "1000h, 1018h:01 and 1018h:02 first";
}

/// The family that the user names may be wrong: the drive's numbers decide before such a request.
TEST_F(AccessAlarm, NoReadWithTheWrongFamilyNamedRaisesOne) {
  for (const auto* line :
       {"read 0x603F -n 1 -d gsd600", "read 0x603F -n 1 -d gsd600 -y", "read Pn0214 0x1008 -n 1,2 -d gsd600",
        "param get Pn0214 -n 1 -d gsd600", "watch 0x603F --for 100ms -n 1 -d gsd600",
        "status -n all -d gsd600", "pdo show -n 1 -d gsd600", "scope 0x603F --for 100ms -n 1 -d gsd600"}) {
    lines.forget_drives();
    EXPECT_NE(lines.perform(line, {}, false), 70) << line << text();
    EXPECT_EQ(access_alarms(lines.frames), "") << line;
    EXPECT_FALSE(lines.frames.empty()) << line;
  }
  EXPECT_EQ(lines.perform("read 0x603F -n 1 -d gsd600 -y", {}, false), 5);
  EXPECT_NE(text().find("not sent: the data of da200 have no such object"), std::string::npos) << text();
  EXPECT_NE(text().find("node 1: not a gsd600: its 0x1000:0 is 0x04020200"), std::string::npos) << text();
}

TEST_F(AccessAlarm, NoAxisOfACabinetFileThatNamesTheWrongFamilyRaisesOne) {
  const auto file = fs::temp_directory_path() / fmt::format("servoctl-wrong-{}.toml", ::getpid());
  std::ofstream(file) << "[bus.main]\nurl = \"sim:da200@1,da200@2\"\n[axis.lift]\nbus = \"main\"\nnode = 1\n"
                         "family = \"gsd600\"\n";
  (void)lines.perform(fmt::format("cabinet show --cabinet {}", file.string()), {}, false);
  EXPECT_EQ(access_alarms(lines.frames), "") << text();
  EXPECT_FALSE(lines.frames.empty()) << text();
  fs::remove(file);
}

TEST_F(AccessAlarm, ANumberThatNoTableListsIsAskedForAfterAQuestion) {
  for (const auto* line :
       {"param get P1.17 -n 1", "read P1.17 -n 1", "read 0x2111 -n 1", "param set P1.17=5 -n 1",
        "watch P1.17 --for 100ms -n 1", "read P1.17 -n 1 --to DIR/p117.bin"}) {
    EXPECT_EQ(lines.perform(line), 8) << line << text();
    EXPECT_NE(
        text().find("The data of da200 do not list it; if the drive does not have it, the request raises "
                    "the alarm Er26-1."),
        std::string::npos)
        << line << text();
    EXPECT_EQ(access_alarms(lines.frames), "") << line;
  }
  EXPECT_NE(lines.perform("param get P1.17 -n 1"), 0);
  EXPECT_NE(text().find("Ask node 1 for P1.17 (0x2111:0)?"), std::string::npos) << text();
  EXPECT_EQ(lines.perform("param get P1.17 -n 1 -y"), 5);
  EXPECT_NE(access_alarms(lines.frames), "") << "the simulated drive does not have it";
  EXPECT_EQ(lines.perform("param get P0.03 -n 1"), 0) << text();
}

TEST_F(AccessAlarm, TheDriveIsInFaultAfterIt) {
  EXPECT_EQ(lines.perform("read 0x6041 -n 1"), 0);
  const auto before = lines.console.out_text;
  lines.console.out_text.clear();
  EXPECT_EQ(lines.perform("read 0x603F 0x6041 -n 1 -y"), 5);
  // It reacts to the fault: bits 3 to 0 are set (CiA 402-2, statusword).
  EXPECT_NE(lines.console.out_text.find("0x021F"), std::string::npos) << lines.console.out_text;
  EXPECT_EQ(before.find("0x021F"), std::string::npos) << before;
}

TEST(AccessWarning, ScanTellsWhichDrivesItAsksForMore) {
  for (const auto& [family, warns] :
       {std::pair{"ts", true}, std::pair{"da200", false}, std::pair{"gsd600", false}}) {
    SampleLines lines(family);
    EXPECT_EQ(lines.perform("scan", {}, false), 0);
    EXPECT_EQ(lines.console.err_text.find("fit no known family") != std::string::npos, warns)
        << family << lines.console.err_text;
  }
}

}  // namespace
}  // namespace servoctl::cli
