// What takes effect by a restart is stored at once, and in force from the next start on.
#include "drive/quantity.hpp"
#include "drive_model_support.hpp"

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;

class RestartEffect : public DriveModelOf {
 protected:
  std::uint64_t in_force(ObjectAddress object) { return load_le(model().values().in_force(object)); }
  std::vector<ObjectAddress> objects() {
    std::vector<ObjectAddress> out;
    for (const auto& object : profile_->dictionary.objects())
      for (const auto& entry : object.entries)
        if (drive::meaning(drive::target_at(profile_.get(), entry.address), 1).effect == od::Effect::restart)
          out.push_back(entry.address);
    return out;
  }
};

/// None is in force before the restart, and each that outlives it is in force after it.
TEST_P(RestartEffect, WaitsForTheRestartForEveryParameterAndObject) {
  for (const auto object : objects()) {
    const auto before = in_force(object);
    bool taken = false;
    for (const auto value : {before + 1, before - 1, std::uint64_t{100}})
      if (!taken && (before > 0 || value != before - 1)) taken = write(object, value) == 0;
    if (!taken) continue;  // Constant, locked or with one value.
    const auto stored = number(object);
    ASSERT_NE(stored, before) << to_string(object);
    EXPECT_EQ(in_force(object), before) << to_string(object) << " took effect at once";
    model().reset_communication(now_);
    EXPECT_EQ(in_force(object), before)
        << to_string(object) << " took effect by a reset of the communication";
    model().power_on(now_);
    EXPECT_EQ(in_force(object), number(object)) << to_string(object);
  }
}

INSTANTIATE_TEST_SUITE_P(Families, RestartEffect, testing::ValuesIn(kFamilies), family_of);

using RestartOf = DriveModelTest;

TEST_F(RestartOf, TheTsIsAPowerCycleAndNoNmtReset) {
  build("ts");
  ASSERT_EQ(write({0x203F, 0}, 9876), 0U);
  ASSERT_EQ(write({0x2000, 0}, 2), 0U);
  model().reset_node(now_);
  EXPECT_EQ(number({0x2000, 0}), 2U);
  EXPECT_EQ(model().setting("Fn_00"), 20U);
  power_cycle();
  EXPECT_EQ(model().setting("Fn_00"), 2U);
}

TEST_F(RestartOf, TheGsd600IsAResetOfTheNodeAsWell) {
  build("gsd600");
  ASSERT_EQ(write({0x2000, 1}, 0), 0U);
  model().reset_node(now_);
  EXPECT_EQ(model().setting("Pn0000"), 0U);
}

TEST_F(RestartOf, TheTorqueSpeedLimitOfTheSv2WaitsForIt) {
  build("sv2");
  ASSERT_TRUE(has({0x2000, 5}));
  const auto before = load_le(model().values().in_force({0x2000, 5}));
  ASSERT_EQ(write({0x2000, 5}, before + 10), 0U);
  EXPECT_EQ(load_le(model().values().in_force({0x2000, 5})), before);
}

TEST_F(RestartOf, WhatNeedsStandstillWaitsForTheEndOfThePowerOnTheDa200) {
  build("da200");
  enable();
  ASSERT_EQ(write({0x6093, 2}, 3), 0U) << "line 374: it takes effect while the servo is disabled";
  EXPECT_NE(load_le(model().values().in_force({0x6093, 2})), 3U);
  EXPECT_EQ(number({0x6093, 2}), 3U);
  ASSERT_EQ(write(objects::kControlword, 0), 0U);
  run(10ms);
  EXPECT_EQ(load_le(model().values().in_force({0x6093, 2})), 3U);
}

}  // namespace
}  // namespace servoctl::sim
