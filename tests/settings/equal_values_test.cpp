// Values that a drive holds already, and writes that alter others.
#include <gtest/gtest.h>

#include "settings/change.hpp"
#include "tests/settings/address_world.hpp"

namespace servoctl::settings {
namespace {

constexpr ObjectAddress kSpeedGain{0x2001, 0x0F};
constexpr ObjectAddress kPositionGain{0x2001, 0x03};

Change equal_values_change(AddressWorld& world, std::string_view name, std::string_view value) {
  const auto target = drive::resolve(world.desk.profile, name).value();
  return make_change(world.desk, 1, target, value, {}).value();
}

TEST(EqualValues, OneThatAnotherWriteOfTheLineAltersIsWrittenAfterAll) {
  AddressWorld world("gsd600", {1});
  const Change changes[] = {equal_values_change(world, "Pn0214", "60Hz"),
                            equal_values_change(world, "Pn0202", "50Hz")};
  // The drive sets its speed gain to 40 Hz when its position gain is written.
  world.hooks.before_send = [&](const can::Frame& frame) {
    if (!can::to_string(frame).starts_with("601#2B012003")) return;
    ASSERT_TRUE(world.bus.send(*can::parse_frame("601#2B01200F90010000")));
    ASSERT_TRUE(world.bus.receive(world.bus.now() + std::chrono::milliseconds(5)));
    ASSERT_EQ(load_le(world.drives[0]->value(kSpeedGain)), 400U);
  };
  ASSERT_TRUE(write_changes(world.desk, changes, {.read_back = true, .leave_equal = true}));
  EXPECT_TRUE(world.desk.errors.empty()) << world.desk.errors.front().message.text();
  EXPECT_EQ(load_le(world.drives[0]->value(kSpeedGain)), 600U);
  EXPECT_EQ(load_le(world.drives[0]->value(kPositionGain)), 500U);
}

}  // namespace
}  // namespace servoctl::settings
