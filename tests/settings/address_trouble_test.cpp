// A drive that does not come to its new address, or not alone: what is told of it.
#include <gtest/gtest.h>

#include "settings/address_change.hpp"
#include "tests/settings/address_world.hpp"

namespace servoctl::settings {
namespace {

using namespace std::chrono_literals;

TEST(AddressTrouble, ADriveThatForgetsAtItsRestartIsToldOf) {
  AddressWorld world("gsd600", {3});
  const auto place = *drive::place_of(world.profile, "Pn0049");
  world.hooks.before_send = [&](const can::Frame& frame) {
    if (is_reset(frame)) world.memory.cells("1")[place] = store_le(3, 2);
  };
  const auto outcome = move_to(world, 3, 5);
  EXPECT_EQ(outcome.end, AddressEnd::failed);
  ASSERT_TRUE(outcome.error);
  EXPECT_NE(outcome.error->message.text().find("forgot"), std::string::npos) << outcome.error->message.text();
}

TEST(AddressTrouble, ADriveThatDoesNotTakeTheNmtCommandIsToBeSwitchedOff) {
  AddressWorld world("gsd600", {3});
  // The command never reaches it.
  world.hooks.before_send = [&](const can::Frame& frame) {
    if (is_reset(frame)) world.drives[0]->wire_faults().silent = true;
  };
  const auto at = world.bus.now() + 5s;
  world.hooks.on_time = [&](TimePoint now) {
    if (now >= at) world.drives[0]->wire_faults().silent = false;
  };
  const auto outcome = move_to(world, 3, 5);
  EXPECT_EQ(outcome.end, AddressEnd::awaits_restart);
  ASSERT_TRUE(outcome.error);
  EXPECT_NE(outcome.error->hint.text().find("switch it off and on"), std::string::npos);
}

TEST(AddressTrouble, ADriveThatAnswersAtBothNodesIsToldOf) {
  AddressWorld world("gsd600", {3});
  bool added = false;
  world.hooks.before_send = [&](const can::Frame& frame) {
    if (!is_reset(frame) || added) return;
    added = true;
    (void)world.bus.send(frame);
    world.add(3);
  };
  const auto outcome = move_to(world, 3, 5);
  EXPECT_EQ(outcome.end, AddressEnd::failed);
  ASSERT_TRUE(outcome.error);
  EXPECT_NE(outcome.error->message.text().find("node 3 still answers"), std::string::npos)
      << outcome.error->message.text();
}

TEST(AddressTrouble, AnotherDriveAtTheNewNodeIsNotTakenForIt) {
  AddressWorld world("gsd600", {3});
  const auto other = drive::load_profile("dm", kFolders).value();
  sim::SimDrive stranger(other, 5, world.memory, "stranger");
  bool added = false;
  world.hooks.before_send = [&](const can::Frame& frame) {
    if (!is_reset(frame) || added) return;
    added = true;
    world.drives[0]->wire_faults().silent = true;
    world.bus.attach(stranger);
    stranger.on_frame(*can::parse_frame("000#8105"), world.bus.now());
  };
  const auto outcome = move_to(world, 3, 5);
  EXPECT_EQ(outcome.end, AddressEnd::failed);
  ASSERT_TRUE(outcome.error);
  EXPECT_NE(outcome.error->message.text().find("is another drive"), std::string::npos)
      << outcome.error->message.text();
}

TEST(AddressTrouble, ADriveThatStaysAwayIsToldOf) {
  AddressWorld world("gsd600", {3});
  world.hooks.before_send = [&](const can::Frame& frame) {
    if (is_reset(frame)) world.drives[0]->wire_faults().silent = true;
  };
  const auto outcome = move_to(world, 3, 5);
  EXPECT_EQ(outcome.end, AddressEnd::failed);
  ASSERT_TRUE(outcome.error);
  EXPECT_EQ(outcome.error->code, Errc::timeout);
  EXPECT_NE(outcome.error->hint.text().find("switch it off and on, and look"), std::string::npos)
      << outcome.error->hint.text();
}

TEST(AddressTrouble, ABusThatIsLostBehindTheWriteLeavesTheEndOpenAndSaysSo) {
  AddressWorld world("gsd600", {3});
  world.hooks.before_send = [&](const can::Frame& frame) {
    world.hooks.lost = world.hooks.lost || is_reset(frame);
  };
  const auto outcome = move_to(world, 3, 5);
  EXPECT_EQ(outcome.end, AddressEnd::failed);
  ASSERT_TRUE(outcome.error);
  EXPECT_EQ(outcome.error->code, Errc::bus);
  EXPECT_NE(outcome.error->message.text().find("was told to be node 5"), std::string::npos)
      << outcome.error->message.text();
}

TEST(AddressTrouble, ABusThatIsLostBehindTheRestartSaysTheSame) {
  // While it starts, and when it is looked for.
  for (const bool starts : {true, false}) {
    AddressWorld world("gsd600", {3});
    std::optional<TimePoint> restarted;
    world.hooks.before_send = [&](const can::Frame& frame) {
      if (is_reset(frame)) restarted = world.bus.now();
      world.hooks.lost = world.hooks.lost || (!starts && restarted && frame.id >= 0x600);
    };
    world.hooks.on_time = [&](TimePoint now) {
      world.hooks.lost = world.hooks.lost || (starts && restarted && now >= *restarted);
    };
    const auto outcome = move_to(world, 3, 5);
    EXPECT_EQ(outcome.end, AddressEnd::failed);
    ASSERT_TRUE(outcome.error);
    EXPECT_EQ(outcome.error->code, Errc::bus);
    EXPECT_NE(outcome.error->message.text().find("was told to be node 5"), std::string::npos)
        << outcome.error->message.text();
  }
}

TEST(AddressTrouble, CtrlCIsHeardWhileTheDriveIsWaitedForAndNotBetweenWriteAndStore) {
  AddressWorld world("gsd600", {3});
  const auto place = *drive::place_of(world.profile, "Pn0049");
  bool pressed = false;
  world.hooks.before_send = [&](const can::Frame& frame) { pressed = pressed || is_write_to(frame, place); };
  const auto change = plan_address(world.desk, 3, {.node = 5});
  ASSERT_TRUE(change);
  world.session->options().cancelled = [&] { return pressed; };
  const auto outcome = change_address(world.desk, *change, {});
  EXPECT_EQ(outcome.end, AddressEnd::failed);
  ASSERT_TRUE(outcome.error);
  EXPECT_EQ(outcome.error->code, Errc::interrupted);
  EXPECT_EQ(world.count("603#2310100173617665"), 1U) << "what was begun is kept";
}

}  // namespace
}  // namespace servoctl::settings
