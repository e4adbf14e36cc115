#include "session/bus_setup.hpp"

#include <gtest/gtest.h>

#include <cerrno>

#include "tests/session/fake_link.hpp"

namespace servoctl::session {
namespace {

using Lines = std::vector<std::string>;

/// What is done to the interface.
Lines bring_up(FakeLink& link, const BusWish& wish) {
  const auto before = link.now;
  const auto plan = plan_bus_up("can0", before, wish);
  if (!plan) return {plan.error().message.text()};
  const auto done = set_up(link, before, *plan);
  if (!done) link.done.push_back(done.error().message.text());
  return link.done;
}

TEST(BusSetup, OfADownInterfaceIsOneMessage) {
  FakeLink link(controller(false, std::nullopt));
  EXPECT_EQ(
      bring_up(link, {.bitrate = 250'000, .sample_point = 800, .restart_ms = 100, .queue_length = 1000}),
      (Lines{" up txqueuelen 1000 type can bitrate 250000 sample-point 0.800 restart-ms 100"}));
  EXPECT_TRUE(link.now.up);
}

TEST(BusSetup, OfADownInterfaceTakesTheBitrateItHas) {
  FakeLink link(controller(false));
  EXPECT_EQ(bring_up(link, {}), (Lines{" up"}));
  FakeLink none(controller(false, std::nullopt));
  EXPECT_EQ(bring_up(none, {}), (Lines{"can0 has no bitrate yet"}));
}

TEST(BusSetup, DoesNothingWhereAllIsAsWanted) {
  FakeLink link(controller(true));
  // 0.86 is what 16 quanta make of 0.875 as well.
  EXPECT_EQ(bring_up(link, {.bitrate = 500'000, .sample_point = 860, .restart_ms = 0, .queue_length = 10}),
            Lines{});
  EXPECT_EQ(bring_up(link, {}), Lines{});
}

TEST(BusSetup, StopsTheBusOnlyForWhatTheControllerHasToBeDownFor) {
  const auto other = plan_bus_up("can0", controller(true), {.bitrate = 250'000});
  ASSERT_TRUE(other.has_value());
  EXPECT_TRUE(other->stops_bus);
  EXPECT_EQ(other->differs, (Lines{"500 kbit/s instead of 250 kbit/s"}));
  const auto sampled = plan_bus_up("can0", controller(true), {.sample_point = 750});
  EXPECT_TRUE(sampled->stops_bus);
  EXPECT_EQ(sampled->steps.back().bitrate, 500'000U);
  const auto queue = plan_bus_up("can0", controller(true), {.queue_length = 1000});
  EXPECT_FALSE(queue->stops_bus);
  ASSERT_EQ(queue->steps.size(), 1U);
  EXPECT_FALSE(queue->steps.front().up.has_value());
}

TEST(BusSetup, BringsABusOffControllerBackWithoutAQuestion) {
  FakeLink link(controller(true));
  link.now.health = can::LinkHealth::bus_off;
  const auto plan = plan_bus_up("can0", link.now, {});
  ASSERT_TRUE(plan.has_value());
  EXPECT_FALSE(plan->stops_bus);
  EXPECT_EQ(bring_up(link, {}), (Lines{" down", " up"}));
}

TEST(BusSetup, EndsListeningOnly) {
  FakeLink link(controller(true));
  link.now.listen_only = true;
  EXPECT_EQ(bring_up(link, {}), (Lines{" down", " up type can listen-only off"}));
  EXPECT_FALSE(link.now.listen_only);
}

TEST(BusSetup, IsPutBackWhenTheKernelRefuses) {
  FakeLink link(controller(true));
  link.refuses = [](const can::LinkChange& change) { return change.bitrate == 777'000U ? EDOM : 0; };
  EXPECT_EQ(
      bring_up(link, {.bitrate = 777'000}),
      (Lines{
          " down", " up type can bitrate 777000", " down", " up type can bitrate 500000 sample-point 0.875",
          "can0 cannot make 777 kbit/s from its clock of 8 MHz; can0 is up again as before, at 500 kbit/s, "
          "sample point 87.5 %"}));
  EXPECT_TRUE(link.now.up);
  EXPECT_EQ(link.now.bitrate, 500'000U);
}

TEST(BusSetup, TakesNoBitrateThatIsOnlyNearTheOneWanted) {
  FakeLink link(controller(true));
  link.makes = [](std::uint32_t bitrate) { return bitrate == 777'777 ? 800'000U : bitrate; };
  const auto done = bring_up(link, {.bitrate = 777'777});
  EXPECT_NE(done.back().find("can0 cannot make 777777 bit/s"), std::string::npos) << done.back();
  EXPECT_EQ(link.now.bitrate, 500'000U);
  EXPECT_TRUE(link.now.up);
}

TEST(BusSetup, SaysWhenItCouldNotBePutBack) {
  FakeLink link(controller(true));
  int left = 1;
  link.refuses = [&](const can::LinkChange&) { return left-- > 0 ? 0 : ENODEV; };
  const auto done = bring_up(link, {.bitrate = 250'000});
  EXPECT_EQ(done.back(), "can0 is gone; can0 could not be put back either, and is down");
}

TEST(BusSetup, OfAVirtualInterfaceHasNoBitrate) {
  can::LinkState vcan;
  vcan.kind = "vcan";
  FakeLink link(vcan);
  EXPECT_EQ(bring_up(link, {.bitrate = 500'000}), (Lines{"can0 (vcan) has no bitrate to set"}));
  EXPECT_EQ(bring_up(link, {}), (Lines{" up"}));
}

TEST(BusSetup, TellsWhatTheControllerRounds) {
  auto now = controller(true);
  EXPECT_EQ(rounded(now, {.bitrate = 500'000, .sample_point = 875}), Lines{});
  now.bitrate = 499'999;
  now.sample_point = 812;
  EXPECT_EQ(rounded(now, {.bitrate = 500'000, .sample_point = 800}),
            (Lines{"the controller cannot make 500 kbit/s: it has 499999 bit/s",
                   "the controller cannot have its sample point at 80.0 %: it is at 81.2 %"}));
}

}  // namespace
}  // namespace servoctl::session
