// Who sends heartbeats, and who watches whom.
#include "settings/heartbeats.hpp"

#include <gtest/gtest.h>

#include "tests/settings/address_world.hpp"

namespace servoctl::settings {
namespace {

using namespace std::chrono_literals;

Result<std::vector<Change>> watch(AddressWorld& world, std::uint8_t node,
                                  std::vector<HeartbeatWatch> watches) {
  return consumer_changes(world.desk, node, watches);
}

bool send_all(AddressWorld& world, const Result<std::vector<Change>>& changes) {
  if (!changes) return false;
  const auto done = write_changes(world.desk, *changes, {.read_back = true});
  return done && world.desk.errors.empty();
}

TEST(Heartbeats, AreReadWithTheirUnit) {
  EXPECT_EQ(*parse_heartbeat_time("100ms"), 100ms);
  EXPECT_EQ(*parse_heartbeat_time("off"), 0ms);
  for (const auto* text : {"100", "1500us", "66s", "-1ms", "", "soon"})
    EXPECT_FALSE(parse_heartbeat_time(text)) << text;
  EXPECT_EQ(parse_heartbeat_watch("3=300ms")->node, 3);
  for (const auto* text : {"3", "=300ms", "0=300ms", "128=300ms", "3=", "x=1s"})
    EXPECT_FALSE(parse_heartbeat_watch(text)) << text;
}

TEST(Heartbeats, ANodeThatIsWatchedHasOneEntryAndKeepsIt) {
  AddressWorld world("gsd600", {1, 3});
  ASSERT_TRUE(send_all(world, watch(world, 1, {{3, 300ms}, {9, 1s}})));
  EXPECT_EQ(load_le(world.drives[0]->value({0x1016, 1})), 0x0003'012CU);
  EXPECT_EQ(load_le(world.drives[0]->value({0x1016, 2})), 0x0009'03E8U);
  ASSERT_TRUE(send_all(world, watch(world, 1, {{9, 2s}})));
  EXPECT_EQ(load_le(world.drives[0]->value({0x1016, 2})), 0x0009'07D0U);
  ASSERT_TRUE(send_all(world, watch(world, 1, {{3, 0ms}})));
  ASSERT_TRUE(send_all(world, watch(world, 1, {{7, 1s}})));
  EXPECT_EQ(load_le(world.drives[0]->value({0x1016, 1})), 0x0007'03E8U) << "the entry that became free";
}

TEST(Heartbeats, AnEntryThatIsFreedInTheLineIsTakenInIt) {
  AddressWorld world("gsd600", {1});
  ASSERT_TRUE(send_all(world, watch(world, 1, {{2, 1s}, {3, 1s}, {4, 1s}, {5, 1s}})));
  EXPECT_FALSE(watch(world, 1, {{6, 1s}}));
  EXPECT_TRUE(send_all(world, watch(world, 1, {{2, 0ms}, {6, 1s}})));
}

TEST(Heartbeats, AWatchThatWouldRaiseAnAlarmAtOnceIsRefused) {
  AddressWorld world("gsd600", {1, 3});
  ASSERT_TRUE(world.session->download(3, objects::kProducerHeartbeat, store_le(300, 2)));
  const auto same = watch(world, 1, {{3, 300ms}});
  ASSERT_FALSE(same);
  EXPECT_EQ(same.error().code, Errc::refused);
  EXPECT_TRUE(watch(world, 1, {{3, 450ms}}));
  EXPECT_TRUE(world.desk.notices.empty()) << world.notices();
  EXPECT_TRUE(watch(world, 1, {{3, 400ms}}));
  EXPECT_NE(world.notices().find("one and a half"), std::string::npos);
}

TEST(Heartbeats, AFamilyWithoutAConsumerIsRefused) {
  AddressWorld world("da200", {1});
  const auto none = watch(world, 1, {{3, 1s}});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, Errc::usage);
  EXPECT_FALSE(watch(world, 1, {{1, 1s}})) << "itself";
}

}  // namespace
}  // namespace servoctl::settings
