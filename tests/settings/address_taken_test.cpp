// Who uses a node-ID: those that answer, those that are heard, and those that are stopped.
#include <gtest/gtest.h>

#include "tests/settings/address_world.hpp"

namespace servoctl::settings {
namespace {

using namespace std::chrono_literals;

TEST(AddressTaken, ANodeIdThatAnswersIsRefused) {
  AddressWorld world("gsd600", {3, 5});
  const std::uint8_t to[] = {5};
  const auto free = refuse_taken(world.desk, to);
  ASSERT_FALSE(free);
  EXPECT_EQ(free.error().code, Errc::refused);
  EXPECT_NE(free.error().message.text().find("it answers"), std::string::npos) << free.error().message.text();
}

TEST(AddressTaken, ANodeIdWhoseNodeOnlySendsHeartbeatsIsRefused) {
  AddressWorld world("gsd600", {3, 5});
  ASSERT_TRUE(world.session->download(5, objects::kProducerHeartbeat, store_le(1000, 2)));
  (void)world.bus.send(*can::parse_frame("000#0205"));
  const std::uint8_t to[] = {5};
  const auto free = refuse_taken(world.desk, to);
  ASSERT_FALSE(free);
  EXPECT_NE(free.error().message.text().find("it sends heartbeats"), std::string::npos)
      << free.error().message.text();
}

TEST(AddressTaken, ANodeIdWhoseNodeIsStoppedIsRefused) {
  AddressWorld world("gsd600", {3, 5});
  (void)world.session->wait([] { return false; }, world.session->now() + 1s);
  (void)world.bus.send(*can::parse_frame("000#0205"));
  const std::uint8_t to[] = {5};
  const auto free = refuse_taken(world.desk, to);
  ASSERT_FALSE(free);
  EXPECT_EQ(free.error().code, Errc::refused);
  EXPECT_NE(free.error().message.text().find("it says that it is stopped (NMT)"), std::string::npos)
      << free.error().message.text();
}

/// Node guarding begins with the first request: a drive that guards its master's life would miss the next.
TEST(AddressTaken, ADryRunAsksNobodyByNodeGuarding) {
  AddressWorld world("gsd600", {3});
  world.desk.dry_run = true;
  const std::uint8_t to[] = {5};
  EXPECT_TRUE(refuse_taken(world.desk, to));
  EXPECT_EQ(world.count("705#R1"), 0U);
  world.desk.dry_run = false;
  EXPECT_TRUE(refuse_taken(world.desk, to));
  EXPECT_EQ(world.count("705#R1"), 1U);
}

TEST(AddressTaken, ABusWithoutRemoteFramesSaysWhatWasNotLookedFor) {
  AddressWorld world("gsd600", {3});
  session::Session session(std::make_unique<HookedBus>(world.bus, world.hooks, world.sent),
                           "socketcand://pi/can0", {});
  world.desk.session = &session;
  const std::uint8_t to[] = {5};
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(refuse_taken(world.desk, to));
  EXPECT_EQ(world.notices(),
            "socketcand://pi/can0 carries no remote frames: nodes that are stopped (NMT) were not looked "
            "for\n");
  EXPECT_EQ(world.count("705#R1"), 0U);
}

TEST(AddressTaken, TheNodeIdOfServoctlsOwnHeartbeatIsRefused) {
  AddressWorld world("gsd600", {3});
  ASSERT_TRUE(world.session->network().arm_watchdog(
      3, {.kind = session::LifeSign::Kind::heartbeat, .producer = 9, .period = 100ms}));
  const std::uint8_t to[] = {9};
  EXPECT_FALSE(refuse_taken(world.desk, to));
  const std::uint8_t other[] = {10};
  EXPECT_TRUE(refuse_taken(world.desk, other));
}

}  // namespace
}  // namespace servoctl::settings
