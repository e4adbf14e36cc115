// `undo` of what was written to axes of a cabinet.
#include "axis_lines.hpp"

namespace servoctl::cli {
namespace {

constexpr std::string_view kTwoBuses = R"([bus.main]
url = "sim:gsd600@1"
[bus.other]
url = "sim:gsd600@2"
[axis.a]
bus = "main"
node = 1
family = "gsd600"
[axis.b]
bus = "other"
node = 2
family = "gsd600"
)";

TEST_F(AxisLines, UndoLeavesTheOtherBusesOfTheCabinetAsTheyAre) {
  write(std::string(kTwoBuses));
  ASSERT_EQ(run("enable -n b --yes"), 0) << all();
  ASSERT_EQ(run("param set Pn0202=60 -n a"), 0) << all();
  EXPECT_EQ(run("undo --yes"), 0) << all();
  EXPECT_TRUE(says("axis") && !says("disabled")) << all();
  EXPECT_EQ(run("status -n b --json"), 0) << all();
  EXPECT_TRUE(says(R"("energised":true)")) << all();
  // What comes behind is as it was: a bus that is not of the cabinet lets it go.
  EXPECT_EQ(run("status -b sim:dm@1 -n 1"), 0) << all();
  EXPECT_TRUE(says("disabled")) << all();
}

TEST_F(AxisLines, UndoOfANumberOnABusOfTheCabinetWantsThatBus) {
  write(std::string(kTwoBuses));
  for (const auto* line : {"bus main", "drive gsd600", "use 1", "param set Pn0202=60", "bus other"})
    ASSERT_EQ(run(line), 0) << line << all();
  EXPECT_EQ(run("undo --yes"), 8) << all();
  EXPECT_TRUE(says("the prompt is not there any more")) << all();
  EXPECT_EQ(run("bus main"), 0) << all();
  EXPECT_EQ(run("undo --yes"), 0) << all();
}

}  // namespace
}  // namespace servoctl::cli
