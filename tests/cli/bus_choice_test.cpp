// Which bus holds where a line, the prompt, the environment and a cabinet file may each name one.
#include "cli/bus_choice.hpp"

#include "axis_lines.hpp"
#include "cli/terminal/prompt_words.hpp"

namespace servoctl::cli {
namespace {

constexpr const char* kOther = "sim:dm@1,dm@2";

/// A shell whose environment names another bus than those of the cabinet file.
class BusChoice : public AxisLines {
 protected:
  BusChoice() { named_by(Source::folder, Source::environment); }

  void named_by(Source cabinet, Source bus) const {
    auto& settings = shell->defaults();
    settings.cabinet = folder / "cabinet.toml";
    settings.cabinet_from = cabinet;
    settings.bus = kOther;
    settings.bus_from = bus;
  }
  std::string file() const { return (folder / "cabinet.toml").string(); }
};

TEST_F(BusChoice, ACabinetFileInTheLineIsStrongerThanABusOfTheEnvironment) {
  shell->defaults().cabinet.clear();
  EXPECT_EQ(run("read statusword -n all --json --cabinet " + file()), 0) << all();
  for (const auto* name : {"feeder1", "feeder2", "table"})
    EXPECT_TRUE(says(std::string("\"axis\":\"") + name + '"')) << name << all();
  EXPECT_TRUE(says("$SERVOCTL_BUS (sim:dm@1,dm@2) is not used: the buses are those of ")) << all();
  EXPECT_TRUE(says("(--cabinet)")) << all();
}

TEST_F(BusChoice, AWriteToAllGoesToTheAxesOfTheFileInTheLine) {
  shell->defaults().cabinet.clear();
  EXPECT_EQ(run("write 0x6083 1234 -n all --json --cabinet " + file()), 0) << all();
  EXPECT_FALSE(says("\"bus\":\"sim:dm")) << all();
  EXPECT_EQ(run("read 0x6083 -n 1 --json"), 0) << all();
  EXPECT_TRUE(says("\"bus\":\"sim:dm@1,dm@2\"")) << all();
  EXPECT_FALSE(says("\"raw\":1234")) << all();
}

TEST_F(BusChoice, ABusAndAFileOfOneLineMustNotContradictEachOther) {
  EXPECT_EQ(run("read statusword -n all -b sim:dm@1 --cabinet " + file()), 2) << all();
  EXPECT_TRUE(says("has no bus sim:dm@1: --bus and --cabinet contradict each other")) << all();
  EXPECT_TRUE(says("main (sim:gsd600@1,gsd600@2,da200@3), ring (coe:sim:sv2@1)")) << all();
  EXPECT_EQ(run("read statusword -n all --json -b main --cabinet " + file()), 0) << all();
  EXPECT_TRUE(says("\"axis\":\"feeder1\"") && !says("\"axis\":\"table\"")) << all();
  EXPECT_EQ(run("read statusword -n all --json -b coe:sim:sv2@1 --cabinet " + file()), 0) << all();
  EXPECT_TRUE(says("\"axis\":\"table\"") && !says("feeder")) << all();
}

/// Whatever was set before, and wherever it contradicts the file.
TEST_F(BusChoice, NothingThatIsSetKeepsADriveFromBeingStopped) {
  ASSERT_EQ(run("enable -n feeder1 --yes"), 0) << all();
  shell->defaults().drive = "ts";
  shell->defaults().drive_from = Source::set;
  EXPECT_EQ(run("stop"), 0) << all();
  shell->defaults().drive.clear();
  EXPECT_EQ(run("status -n feeder1 --json"), 0) << all();
  EXPECT_TRUE(says(R"("energised":false)")) << all();
  named_by(Source::environment, Source::environment);
  EXPECT_NE(run("stop --json"), 2) << all();
  EXPECT_TRUE(says(R"("axis":"feeder1")") && says(R"("bus":"sim:dm@1,dm@2")")) << all();
  EXPECT_EQ(run("disable -n 1 --json"), 0) << all();
  EXPECT_TRUE(says(R"("bus":"sim:dm@1,dm@2")") && !says("feeder1")) << "numbers are of the bus: " << all();
  write("[bus.main");
  EXPECT_EQ(run("disable -n 1"), 0) << "the file cannot be read: " << all();
  EXPECT_TRUE(says("the cabinet file is not used")) << all();
}

TEST_F(BusChoice, ABusOfTheEnvironmentThatTheFileNamesLeavesNoAxisOut) {
  named_by(Source::folder, Source::environment);
  shell->defaults().bus = "main";
  EXPECT_EQ(run("status -n all --json --cabinet " + file()), 0) << all();
  EXPECT_TRUE(says("\"axis\":\"feeder1\"") && says("\"axis\":\"table\"")) << all();
}

TEST_F(BusChoice, TheSameOfTheEnvironment) {
  named_by(Source::environment, Source::environment);
  EXPECT_EQ(run("status -n all"), 2) << all();
  EXPECT_TRUE(says("$SERVOCTL_BUS and $SERVOCTL_CABINET contradict each other")) << all();
  EXPECT_EQ(run("status -n 1 -b sim:dm@1"), 0) << all();
  EXPECT_EQ(run("status -n feeder1"), 0) << "an axis in the line is stronger: " << all();
  EXPECT_TRUE(says("$SERVOCTL_BUS (sim:dm@1,dm@2) is not used: cabinet.toml says it of each axis")) << all();
}

TEST_F(BusChoice, AnAxisAndABusOfTheEnvironmentMustNotContradictEachOther) {
  shell->defaults().nodes = "feeder1";
  EXPECT_EQ(run("status"), 2) << all();
  EXPECT_TRUE(says("feeder1 is on bus main (sim:gsd600@1,gsd600@2,da200@3) by cabinet.toml, not on " +
                   std::string(kOther)))
      << all();
  EXPECT_TRUE(says("unset $SERVOCTL_BUS")) << all();
}

TEST_F(BusChoice, ABusOfTheEnvironmentIsStrongerThanTheFileOfTheFolder) {
  EXPECT_EQ(run("status -n 1 --json"), 0) << all();
  EXPECT_TRUE(says("\"bus\":\"sim:dm@1,dm@2\"")) << all();
}

TEST_F(BusChoice, AFamilyOfTheEnvironmentLosesToAnAxisOfTheLineAndIsTold) {
  shell->defaults().drive = "da200";
  shell->defaults().bus.clear();
  EXPECT_EQ(run("param get Pn0202 -n feeder1"), 0) << all();
  EXPECT_TRUE(says("$SERVOCTL_DRIVE (da200) is not used: cabinet.toml says it of each axis")) << all();
  shell->defaults().drive_from = Source::line;
  EXPECT_EQ(run("status -n feeder1 -d da200"), 2) << all();
}

TEST_F(BusChoice, AtThePromptTheLaterWordHolds) {
  shell->defaults().cabinet_from = Source::set;
  ASSERT_EQ(run("bus sim:dm@1"), 0) << all();
  EXPECT_EQ(run("use table"), 0) << all();
  EXPECT_TRUE(says("bus sim:dm@1 is no longer chosen")) << all();
  EXPECT_EQ(run("status --json"), 0) << all();
  EXPECT_TRUE(says("\"bus\":\"coe:sim:sv2@1\"")) << all();
  EXPECT_EQ(run("bus main"), 0) << all();
  EXPECT_TRUE(says("the axis table is no longer chosen")) << all();
  EXPECT_EQ(run("status"), 2) << "no line goes to a bus that nobody meant: " << all();
  EXPECT_EQ(run("use feeder1"), 0) << all();
  EXPECT_EQ(run("drive da200"), 2) << all();
  EXPECT_TRUE(says("feeder1 is gsd600 by the cabinet file, not da200")) << all();
}

TEST_F(BusChoice, CommandsOfTheWholeFileTakeNoPlaceOfTheirOwn) {
  for (const auto* place : {"-b sim:dm@1", "-n 1", "-d dm"}) {
    EXPECT_EQ(run(std::string("cabinet plan ") + place), 2) << all();
    EXPECT_TRUE(says("is for lines that name their own nodes")) << all();
  }
  EXPECT_EQ(run("cabinet check"), 0) << all();
}

TEST_F(BusChoice, VerboseSaysWhereTheLineGoesAndWhoSaidSo) {
  EXPECT_EQ(run("status -n 1 --verbose"), 0) << all();
  EXPECT_TRUE(says("bus sim:dm@1,dm@2: named by $SERVOCTL_BUS; nodes 1: named by --node")) << all();
}

TEST_F(BusChoice, SettingsForLinesLoseTheBusThatTheFileReplaces) {
  auto settings = shell->defaults();
  settings.cabinet_from = Source::line;
  const auto settled = shell->settings_for_lines(settings);
  ASSERT_TRUE(settled) << settled.error().message.text();
  EXPECT_EQ(settled->bus, "");
  EXPECT_EQ(settled->cabinet_from, Source::set);
  settings.bus_from = Source::line;
  EXPECT_FALSE(shell->settings_for_lines(settings));
}

}  // namespace
}  // namespace servoctl::cli
