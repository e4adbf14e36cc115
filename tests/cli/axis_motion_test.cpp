// Motions and writes of axes by name: what the file says of the load, the limits and the drive itself.
#include "axis_lines.hpp"

namespace servoctl::cli {
namespace {

using AxisMotion = AxisLines;

TEST_F(AxisMotion, WhatOneFamilyDoesNotTakeKeepsTheOthersFromBeingWritten) {
  EXPECT_EQ(run("param set feeder1,送料 Pn0202 47Hz"), 2) << all();
  EXPECT_TRUE(says("'Pn0202' is not a panel parameter of da200")) << all();
  EXPECT_EQ(run("param get feeder1 Pn0202 --json"), 0) << all();
  EXPECT_TRUE(says(R"("raw":400,)")) << all();
}

TEST_F(AxisMotion, ALoadThatRunsTheOtherWayIsMovedItsWayAndLimitedAsItIs) {
  write(R"([bus.main]
url = "sim:gsd600@1"
[axis.lift]
node = 1
family = "gsd600"
turn = 10000
per_turn = "-20 mm"
limits = { speed = "100mm/s" }
)");
  EXPECT_EQ(run("cabinet check"), 0) << all();
  EXPECT_EQ(run("move lift 20mm --speed 50mm/s --accel 500mm/s2 --yes"), 0) << all();
  EXPECT_TRUE(says("go by -360 deg (20 mm), to -360 deg (20 mm), at 150 rpm")) << all();
  EXPECT_EQ(run("read 0x6064 -n lift --json"), 0) << all();
  EXPECT_TRUE(says(R"("value":-10000,)")) << all();
  EXPECT_EQ(run("jog lift 50mm/s --for 100ms --yes"), 0) << all();
  EXPECT_TRUE(says("-150 rpm (50 mm/s)")) << all();
  EXPECT_EQ(run("jog lift 101mm/s --for 100ms --yes"), 8) << all();
  EXPECT_TRUE(says("raises it, if the machine may move that fast; the cabinet file says it: `limits.speed`"))
      << all();
  EXPECT_EQ(run("jog lift 101mm/s --limit 100mm/s --for 100ms --yes"), 8) << all();
  EXPECT_FALSE(says("limits.speed")) << "it was typed: " << all();
  EXPECT_EQ(run("home 35 -n lift --offset 20mm --speed 20mm/s --search 10mm/s --dry-run"), 0) << all();
  EXPECT_TRUE(says("0x607C:0")) << all();
  EXPECT_TRUE(says("601#237C6000F0D8FFFF")) << all();  // -10000
  EXPECT_EQ(run("move lift 20mm --speed -50mm/s --yes"), 2) << all();
  EXPECT_EQ(run("move lift 20mm --speed 0.0001um/s --yes"), 2) << all();
}

TEST_F(AxisMotion, AWayLongerThanTheWindowIsRefusedBeforeAnythingMoves) {
  EXPECT_EQ(run("move feeder1 20mm --window 1mm --yes"), 8) << all();
  EXPECT_TRUE(says("the way of 3600 deg (20 mm) is longer than --window allows, 180 deg (1 mm)")) << all();
  EXPECT_EQ(run("read 0x6064 -n feeder1 --json"), 0) << all();
  EXPECT_TRUE(says(R"("value":0,)")) << all();
}

TEST_F(AxisMotion, ALineThatChangesADriveHoldsItsSerialNumberAgainstTheFile) {
  write("[bus.main]\nurl = \"sim:da200@1\"\n[axis.lift]\nnode = 1\nfamily = \"da200\"\nserial = 17\n");
  EXPECT_EQ(run("param set lift P0.05 1"), 8) << all();
  EXPECT_TRUE(says("the drive has the serial number 16 (0x00000010), and the file says 17 (0x00000011)"))
      << all();
  EXPECT_EQ(run("jog lift 10rpm --for 1s --yes"), 8) << all();
  EXPECT_EQ(run("read statusword -n lift"), 0) << all();
  EXPECT_EQ(run("disable -n lift"), 0) << "a way out is never refused: " << all();
}

TEST_F(AxisMotion, AxesOfOneFamilyHaveTheirCountsTogether) {
  EXPECT_EQ(run("units show -n feeder1,feeder2 --json"), 0) << all();
  EXPECT_TRUE(says(R"("axis":"feeder2")") && !says(R"("value":null)")) << all();
}

TEST_F(AxisMotion, HomingWhereItStandsIsNotRefusedForASpeedItDoesNotUse) {
  EXPECT_EQ(run("home 35 -n table --yes"), 0) << all();
  EXPECT_EQ(run("home 17 -n table --panel PA-20=0,PA-74=1 --yes"), 8) << all();
  EXPECT_TRUE(says("is above the limit of 300 rpm")) << all();
}

}  // namespace
}  // namespace servoctl::cli
