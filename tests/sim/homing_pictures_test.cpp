// Where each homing method of CiA 402-2 ends, from every side the standard draws.
#include "homing_support.hpp"

#include <ios>

namespace servoctl::sim {
namespace {

/// A picture of CiA 402-2: from where the axis starts, how it begins, where it finds home and in which
/// direction. The home switch is pressed from 1 to 3.5, limits stand at -2 and 6, pulses come at x.25.
struct Picture {
  int method;
  double from;
  int first;
  int last;
  double home;
};

class Pictures : public HomingTest, public testing::WithParamInterface<Picture> {};

TEST_P(Pictures, OfTheStandardEndWhereTheyAreDrawn) {
  const auto& picture = GetParam();
  stand_at(picture.from);
  enable("6");
  const auto run = home(picture.method);
  EXPECT_EQ(run.statusword & (kReached | kAttained | kError), kReached | kAttained)
      << std::hex << run.statusword;
  EXPECT_NEAR(run.home, picture.home, 1e-4);
  EXPECT_EQ(run.rest, 0);
  EXPECT_EQ(run.first, picture.first);
  EXPECT_EQ(run.last, picture.last);
  EXPECT_LE(run.fastest_end, 1.001) << "it is found at the slow speed";
}

constexpr Picture kPictures[] = {
    {1, 0, -1, 1, -1.75},  {1, -3, 1, 1, -1.75},  // Negative limit, pulse.
    {2, 0, 1, -1, 5.25},   {2, 7, -1, -1, 5.25},  // Positive limit, pulse.
    {3, 0, 1, -1, 0.25},   {3, 2, -1, -1, 0.25},  // Home switch to the right.
    {4, 0, 1, 1, 1.25},    {4, 2, -1, 1, 1.25},     {5, 5, -1, 1, 4.25},
    {5, 2, 1, 1, 4.25},  // Home switch to the left.
    {6, 5, -1, -1, 3.25},  {6, 2, 1, -1, 3.25},     {7, 0, 1, -1, 0.25},
    {7, 2, -1, -1, 0.25},  {7, 5, 1, -1, 0.25},                          // Home switch in between, first
    {8, 0, 1, 1, 1.25},    {8, 2, -1, 1, 1.25},     {8, 5, 1, 1, 1.25},  // to the positive limit.
    {9, 0, 1, -1, 3.25},   {9, 2, 1, -1, 3.25},     {9, 5, 1, -1, 3.25},
    {10, 0, 1, 1, 4.25},   {10, 2, 1, 1, 4.25},     {10, 5, 1, 1, 4.25},
    {11, 5, -1, 1, 4.25},  {11, 2, 1, 1, 4.25},     {11, 0, -1, 1, 4.25},  // First to the negative limit.
    {12, 5, -1, -1, 3.25}, {12, 2, 1, -1, 3.25},    {12, 0, -1, -1, 3.25},
    {13, 5, -1, 1, 1.25},  {13, 2, -1, 1, 1.25},    {13, 0, -1, 1, 1.25},
    {14, 5, -1, -1, 0.25}, {14, 2, -1, -1, 0.25},   {14, 0, -1, -1, 0.25},
    {17, 0, -1, 1, -2},    {17, -3, 1, 1, -2},  // The same without the pulse.
    {18, 0, 1, -1, 6},     {18, 7, -1, -1, 6},      {19, 0, 1, -1, 1},
    {19, 2, -1, -1, 1},    {20, 0, 1, 1, 1},        {20, 2, -1, 1, 1},
    {21, 5, -1, 1, 3.5},   {21, 2, 1, 1, 3.5},      {22, 5, -1, -1, 3.5},
    {22, 2, 1, -1, 3.5},   {23, 0, 1, -1, 1},       {23, 2, -1, -1, 1},
    {23, 5, 1, -1, 1},     {24, 0, 1, 1, 1},        {24, 2, -1, 1, 1},
    {24, 5, 1, 1, 1},      {25, 0, 1, -1, 3.5},     {25, 2, 1, -1, 3.5},
    {25, 5, 1, -1, 3.5},   {26, 0, 1, 1, 3.5},      {26, 2, 1, 1, 3.5},
    {26, 5, 1, 1, 3.5},    {27, 5, -1, 1, 3.5},     {27, 2, 1, 1, 3.5},
    {27, 0, -1, 1, 3.5},   {28, 5, -1, -1, 3.5},    {28, 2, 1, -1, 3.5},
    {28, 0, -1, -1, 3.5},  {29, 5, -1, 1, 1},       {29, 2, -1, 1, 1},
    {29, 0, -1, 1, 1},     {30, 5, -1, -1, 1},      {30, 2, -1, -1, 1},
    {30, 0, -1, -1, 1},    {33, 0.5, -1, -1, 0.25}, {34, 0.5, 1, 1, 1.25},  // The pulse alone.
    {35, 0.5, 0, 0, 0.5},  {37, 0.5, 0, 0, 0.5},                            // Where it stands.
};

INSTANTIATE_TEST_SUITE_P(Homing, Pictures, testing::ValuesIn(kPictures), [](const auto& row) {
  const auto tenths = std::to_string(std::abs(static_cast<int>(row.param.from * 10)));
  return "method_" + std::to_string(row.param.method) + "_from_" + (row.param.from < 0 ? "minus_" : "") +
         tenths;
});

}  // namespace
}  // namespace servoctl::sim
