// Lines of several nodes, and lines that energised drives do not take, on simulated drives in virtual time.
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/line_runner.hpp"
#include "cli/shell.hpp"
#include "recording_console.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {
namespace {

class EnergisedLines : public testing::Test {
 protected:
  EnergisedLines() { open("sim:gsd600@1,gsd600@2", "gsd600"); }

  void open(const std::string& bus, const std::string& family) {
    Shell::Options options;
    options.drive_folders = {std::filesystem::path(source_dir()) / "eds"};
    options.clock = sim::SimBus::Clock::virtual_time;
    options.defaults.bus = bus;
    options.defaults.drive = family;
    options.cancelled = [this] { return looks_left-- <= 0; };
    shell = std::make_unique<Shell>(console, options);
    shell->stay_open(true);
  }
  int run(std::string_view line) {
    console.out_text.clear();
    console.err_text.clear();
    console.questions.clear();
    return LineRunner(*shell).run(line);
  }
  std::string all() const { return console.out_text + console.err_text; }
  bool says(std::string_view what) const { return all().find(what) != std::string::npos; }
  bool energised(int node) {
    looks_left = kForEver;
    EXPECT_EQ(run("status --json -n " + std::to_string(node)), 0) << all();
    return says(R"("energised":true)");
  }

  static constexpr int kForEver = 100'000'000;
  int looks_left = kForEver;  ///< How often the shell may ask whether it is cancelled.
  RecordingConsole console;
  std::unique_ptr<Shell> shell;
};

TEST_F(EnergisedLines, ARefusalOfTheSecondNodeEnablesNeither) {
  ASSERT_EQ(run("enable -n 2 --yes"), 0) << all();
  EXPECT_EQ(run("enable -n 1,2 --yes"), 8) << all();
  EXPECT_TRUE(says("   1  switch on disabled  not enabled\n")) << all();
  EXPECT_TRUE(says("   2  operation enabled   failed\n")) << all();
  EXPECT_FALSE(energised(1));
}

TEST_F(EnergisedLines, AQuestionIsAskedForEveryNodeBeforeTheFirstIsEnabled) {
  console.person = true;
  console.answer = true;
  console.refuses_from = 2;
  EXPECT_EQ(run("enable -n 1,2"), 8) << all();
  EXPECT_EQ(console.questions.size(), 2U);
  EXPECT_FALSE(energised(1));
  console.refuses_from = 3;
  EXPECT_EQ(run("enable -n 1,2"), 0) << all();
  EXPECT_TRUE(energised(1) && energised(2));
}

TEST_F(EnergisedLines, APlanWithARefusedNodeSendsNothing) {
  ASSERT_EQ(run("enable -n 2 --yes"), 0) << all();
  EXPECT_EQ(run("enable -n 1,2 --dry-run"), 8) << all();
  EXPECT_FALSE(says("0x6040")) << all();
}

TEST_F(EnergisedLines, WhereverEnablingEndsAnErrorLeavesNoMotorEnergised) {
  int ended_between = 0;
  for (int looks = 20;; looks += 3) {
    open("sim:gsd600@1,gsd600@2", "gsd600");
    looks_left = looks;
    const int code = run("enable -n 1,2 --yes");
    const auto told = all();
    const bool taken_back = says("node 1 had been enabled by this line; it has been stopped and disabled");
    if (taken_back) {
      EXPECT_TRUE(says("   1  switch on disabled  disabled again\n")) << told;
    }
    ended_between += taken_back ? 1 : 0;
    if (code == 0) {
      EXPECT_TRUE(energised(1) && energised(2));
      break;
    }
    ASSERT_FALSE(energised(1)) << "after " << looks << " looks: " << told;
    ASSERT_FALSE(energised(2)) << "after " << looks << " looks: " << told;
  }
  EXPECT_GT(ended_between, 0);
}

TEST_F(EnergisedLines, FactoryValuesAreNotRestoredInADriveThatIsEnergised) {
  ASSERT_EQ(run("enable -n 2 --yes"), 0) << all();
  ASSERT_EQ(run("param set Pn0214=45Hz -n 1,2"), 0) << all();
  EXPECT_EQ(run("defaults -n 1,2 --yes"), 8) << all();
  EXPECT_TRUE(says("node 2: it is energised: its settings cannot be changed now")) << all();
  EXPECT_TRUE(says("`disable -n 2` de-energises it")) << all();
  console.person = true;
  EXPECT_EQ(run("defaults -n 2"), 8) << all();
  EXPECT_TRUE(console.questions.empty()) << "it is refused before anybody is asked";
  ASSERT_EQ(run("disable -n 2"), 0) << all();
  EXPECT_EQ(run("defaults -n 1,2 --yes"), 0) << all();
}

TEST_F(EnergisedLines, WhatIsSetIsStoredInADriveThatIsEnergised) {
  ASSERT_EQ(run("enable -n 2 --yes"), 0) << all();
  EXPECT_EQ(run("store -n 2 --yes"), 0) << all();
}

TEST_F(EnergisedLines, OneParameterStandsOnceInALineHoweverItIsWritten) {
  for (const auto* line : {"param set Pn0207=5 Pn0207=6 -n 1", "param set Pn0207=5 pn0207=5 -n 1",
                           "param set Pn0207=5 Pn0214=45Hz 0x2001:08=6 -n 1,2"}) {
    EXPECT_EQ(run(line), 2) << line << all();
    EXPECT_TRUE(says("two values for one parameter: ")) << line << all();
    EXPECT_EQ(run("param get Pn0207 --json -n 1"), 0);
    EXPECT_TRUE(says(R"("raw":0,)")) << "nothing was written: " << all();
  }
  EXPECT_EQ(run("param set Pn0207=5 Pn0214=45Hz -n 1,2"), 0) << all();
}

TEST_F(EnergisedLines, AParameterThatEnergisesIsAskedForAndTold) {
  open("sim:ts@1", "ts");
  EXPECT_EQ(run("param set Fn_38=1 -n 1"), 8) << all();
  EXPECT_TRUE(
      says("Write Fn_38 Servo enable on node 1? This may energise the motor, or set it in motion, without "
           "the controlword; `disable` may not stop it."))
      << all();
  EXPECT_EQ(run("write 0x2038 1 -n 1"), 8) << all();
  EXPECT_TRUE(says("This may energise the motor")) << "an address is the same: " << all();
  EXPECT_EQ(run("param set Fn_38=1 -n 1 --yes"), 0) << all();
  EXPECT_TRUE(
      says("notice: node 1: its motor may get power or move without the controlword, and servoctl neither "
           "supervises nor stops it: `param set Fn_38=0 -n 1"))
      << all();
  EXPECT_EQ(run("param set Fn_20C=1 -n 1 --yes"), 0) << all();
  EXPECT_TRUE(says("`param set Fn_20E=1 -n 1")) << all();
  EXPECT_EQ(run("param set Fn_38=0 Fn_20C=0 -n 1 --yes"), 0) << all();
  EXPECT_FALSE(says("its motor may get power")) << all();
}

constexpr std::string_view kNotice =
    "notice: node 1 IS ENERGISED and not supervised; `disable -n 1` de-energises it\n";

TEST_F(EnergisedLines, ADriveThatIsEnergisedIsToldWhicheverCommandDidIt) {
  const std::vector<std::vector<std::string>> ways{
      {"enable -n 1 --yes"},
      {"write 0x6040 6 -n 1", "write 0x6040 7 -n 1", "write 0x6040 15 -n 1 --yes"},
      {"nmt start -n 1", "pdo send RPDO1 6 -n 1 --yes", "pdo send RPDO1 7 -n 1 --yes",
       "pdo send RPDO1 15 -n 1 --yes"}};
  for (const auto& way : ways) {
    SCOPED_TRACE(way.back());
    open("sim:gsd600@1", "gsd600");
    for (const auto& line : way) {
      EXPECT_FALSE(says("ENERGISED")) << all();
      ASSERT_EQ(run(line), 0) << all();
    }
    EXPECT_TRUE(says(kNotice)) << all();
    run("read 0x6041 -n 1");
    EXPECT_FALSE(says("ENERGISED")) << "once: " << all();
  }
}

/// Seen at rest it is nothing but not yet energised.
TEST_F(EnergisedLines, ADriveThatObeysAtTheNextSyncIsNotForgottenBeforeIt) {
  open("sim:gsd600@1", "gsd600");
  for (const auto* line :
       {"nmt start -n 1", "write 0x6040 6 -n 1", "write 0x6040 7 -n 1", "pdo disable RPDO1 -n 1 --yes",
        "write 0x1400:2 1 -n 1", "pdo enable RPDO1 -n 1 --yes"})
    ASSERT_EQ(run(line), 0) << line << all();
  ASSERT_EQ(run("pdo send RPDO1 15 -n 1 --yes"), 0) << all();
  EXPECT_TRUE(says("may become energised")) << all();
  ASSERT_EQ(run("status -n 1"), 0) << all();
  ASSERT_EQ(run("sync once --yes"), 0) << all();
  ASSERT_TRUE(energised(1));
  shell->let_go();
  EXPECT_TRUE(says("node 1 was still energised; it has been stopped and disabled")) << all();
  EXPECT_FALSE(energised(1));
}

TEST_F(EnergisedLines, WhatIsLeftEnergisedIsToldWhenTheLinesEnd) {
  ASSERT_EQ(run("enable -n 1 --yes"), 0) << all();
  ASSERT_EQ(run("read 0x6041 -n 1"), 0) << all();
  EXPECT_EQ(shell->close(0), 0);
  EXPECT_TRUE(says(kNotice)) << all();
  open("sim:gsd600@1", "gsd600");
  ASSERT_EQ(run("enable -n 1 --yes"), 0) << all();
  console.out_text.clear();
  console.err_text.clear();
  EXPECT_EQ(shell->close(0), 0);
  EXPECT_FALSE(says("ENERGISED")) << "the last line told it: " << all();
}

TEST_F(EnergisedLines, ASignalBehindTheLastLineLeavesNothingEnergised) {
  ASSERT_EQ(run("enable -n 1 --yes"), 0) << all();
  looks_left = 0;
  EXPECT_EQ(shell->close(0), 130);
  EXPECT_TRUE(says("node 1 was still energised; it has been stopped and disabled")) << all();
}

TEST_F(EnergisedLines, StopTakesTheWayDownOfEverythingWhateverIsInUse) {
  for (const auto& [bus, family] :
       {std::pair("sim:gsd600@1,gsd600@2", "gsd600"), std::pair("coe:sim:sv2@1,sv2@2", "sv2")}) {
    SCOPED_TRACE(bus);
    open(bus, family);
    ASSERT_EQ(run("enable -n 1,2 --yes"), 0) << all();
    ASSERT_EQ(run("use 1"), 0) << all();
    EXPECT_EQ(run("stop"), 0) << all();
    EXPECT_TRUE(console.questions.empty());
    EXPECT_FALSE(energised(1));
    EXPECT_FALSE(energised(2));
    ASSERT_EQ(run("enable -n 1,2 --yes"), 0) << all();
    EXPECT_EQ(run("stop -n 1"), 0) << all();
    EXPECT_FALSE(energised(1));
    EXPECT_TRUE(energised(2)) << "a line with -n of its own is for that";
    EXPECT_EQ(run("stop"), 0) << all();
  }
}

TEST_F(EnergisedLines, OneThatEnergisesFromTheNextStartOnSaysSo) {
  EXPECT_EQ(run("param set Pn0600=1 -n 1"), 8) << all();
  EXPECT_TRUE(says("After a restart of the drive this may energise the motor without the controlword."))
      << all();
  EXPECT_EQ(run("param set Pn0600=0 -n 1"), 0) << all();
}

}  // namespace
}  // namespace servoctl::cli
