#include "motion/motion_needs.hpp"

#include <gtest/gtest.h>

#include "tests/source_dir.hpp"

namespace servoctl::motion {
namespace {

const std::filesystem::path kNeedsFolders[] = {std::filesystem::path(source_dir()) / "eds"};

drive::Profile profile_of(const std::string& name) {
  return drive::load_profile((std::filesystem::path(source_dir()) / "tests/cli/data" / name).string(),
                             kNeedsFolders)
      .value();
}

TEST(MotionNeeds, NamesTheObjectAndTheModeThatADataSheetLacks) {
  const auto profile = profile_of("pp.eds");
  EXPECT_EQ(mode_for(profile, drive::Use::move).value(), 1);
  const auto jog = mode_for(profile, drive::Use::jog);
  ASSERT_FALSE(jog);
  EXPECT_EQ(jog.error().code, Errc::refused);
  EXPECT_NE(jog.error().message.text().find("has no 0x60FF:0 (Target velocity), and its 0x6502 is 0x21"),
            std::string::npos)
      << jog.error().message.text();
  EXPECT_EQ(jog.error().hint.text(), "possible with this drive: `move`");
  EXPECT_FALSE(mode_for(profile, drive::Use::torque));
}

/// 6502h has the homing mode; the file lacks 6098h.
TEST(MotionNeeds, SaysWhatACommandNeedsWhereTheModeIsThere) {
  const auto home = mode_for(profile_of("pp.eds"), drive::Use::home);
  ASSERT_FALSE(home);
  EXPECT_NE(home.error().message.text().find("has no 0x6098:0 (Homing method), which `home` needs"),
            std::string::npos)
      << home.error().message.text();
}

TEST(MotionNeeds, FindsEveryModeOfTheStandard) {
  const auto profile = drive::load_profile("cia402", kNeedsFolders).value();
  for (const auto& [use, mode] : {std::pair{drive::Use::jog, 3}, std::pair{drive::Use::move, 1},
                                  std::pair{drive::Use::torque, 4}, std::pair{drive::Use::home, 6}})
    EXPECT_EQ(mode_for(profile, use).value(), mode);
  EXPECT_EQ(possible_motions(profile, 0x21), "possible with this drive: `move`, `home`");
  EXPECT_EQ(possible_motions(profile, 0x40), "");
}

}  // namespace
}  // namespace servoctl::motion
