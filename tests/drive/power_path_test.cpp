// Every state against every goal: the ways are written out by hand from figure 8 of CiA 402-2.
#include "drive/power_path.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <string>

namespace servoctl::drive {
namespace {

constexpr DriveState kEveryState[] = {DriveState::not_ready_to_switch_on,
                                      DriveState::switch_on_disabled,
                                      DriveState::ready_to_switch_on,
                                      DriveState::switched_on,
                                      DriveState::operation_enabled,
                                      DriveState::quick_stop_active,
                                      DriveState::fault_reaction_active,
                                      DriveState::fault,
                                      DriveState::unknown};

/// `06 07`, `auto 06`, `-` where there is no way.
std::string way(DriveState from, DriveState to, bool resumes) {
  const auto path = power_path(from, to, resumes);
  if (!path) return "-";
  std::string out;
  for (const auto& step : *path) {
    char word[8] = "auto";
    if (step.controlword) std::snprintf(word, sizeof word, "%02X", *step.controlword);
    out += (out.empty() ? "" : " ") + std::string(word);
  }
  return out;
}

TEST(PowerPath, IsTheShortestLegalOneFromEveryStateToEveryState) {
  // Rows: from; columns: to, both in the order of kEveryState. An empty text: already there.
  const std::vector<std::vector<std::string>> expected{
      {"", "auto", "auto 06", "auto 06 07", "auto 06 07 0F", "auto 06 07 0F 02", "-", "-", "-"},
      {"-", "", "06", "06 07", "06 07 0F", "06 07 0F 02", "-", "-", "-"},
      {"-", "00", "", "07", "07 0F", "07 0F 02", "-", "-", "-"},
      {"-", "00", "06", "", "0F", "0F 02", "-", "-", "-"},
      {"-", "00", "06", "07", "", "02", "-", "-", "-"},
      {"-", "00", "00 06", "00 06 07", "00 06 07 0F", "", "-", "-", "-"},
      {"-", "-", "-", "-", "-", "-", "", "auto", "-"},
      {"-", "-", "-", "-", "-", "-", "-", "", "-"},
      {"-", "-", "-", "-", "-", "-", "-", "-", ""},
  };
  for (std::size_t from = 0; from < std::size(kEveryState); ++from)
    for (std::size_t to = 0; to < std::size(kEveryState); ++to)
      EXPECT_EQ(way(kEveryState[from], kEveryState[to], false), expected[from][to])
          << name(kEveryState[from]) << " -> " << name(kEveryState[to]);
}

TEST(PowerPath, ResumesAfterAQuickStopOnlyWhereTheDriveAllowsIt) {
  EXPECT_EQ(way(DriveState::quick_stop_active, DriveState::operation_enabled, true), "0F");
  EXPECT_EQ(way(DriveState::quick_stop_active, DriveState::switched_on, true), "0F 07");
  EXPECT_EQ(way(DriveState::quick_stop_active, DriveState::switch_on_disabled, true), "00");
}

TEST(PowerPath, NamesTheStateThatEachStepReaches) {
  const auto path = power_path(DriveState::switch_on_disabled, DriveState::operation_enabled, false);
  ASSERT_TRUE(path);
  const std::vector<PowerStep> expected{{0x06, DriveState::ready_to_switch_on},
                                        {0x07, DriveState::switched_on},
                                        {0x0F, DriveState::operation_enabled}};
  EXPECT_EQ(*path, expected);
}

TEST(PowerPath, EveryStepIsOneTheStateMachineTakes) {
  for (const auto from : kEveryState) {
    for (const auto to : kEveryState) {
      auto state = from;
      for (const auto& step : power_path(from, to, true).value_or(std::vector<PowerStep>{})) {
        if (step.controlword) {
          EXPECT_EQ(next_state(state, decode_command(*step.controlword, 0)), step.reached);
        }
        state = step.reached;
      }
    }
  }
}

}  // namespace
}  // namespace servoctl::drive
