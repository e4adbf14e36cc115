// Drives and the interface of their bus go to another bitrate together: nobody is left behind, and where it
// fails the error says where everybody is.
#include <gtest/gtest.h>

#include "tests/settings/bitrate_cell.hpp"

namespace servoctl::settings {
namespace {

using namespace std::chrono_literals;

class BitrateOf : public testing::TestWithParam<const char*> {};

TEST_P(BitrateOf, DrivesAreRestartedByOneCommandAndFoundAtTheNewBitrate) {
  BitrateCell cell(GetParam());
  const auto out = cell.run();
  ASSERT_EQ(out.size(), 2U);
  for (const auto& each : out) {
    EXPECT_EQ(each.end, AddressEnd::at_bitrate) << (each.error ? each.error->message.text() : "");
    EXPECT_FALSE(each.error);
  }
  EXPECT_EQ(cell.bitrate(), 125'000U);
  EXPECT_TRUE(cell.link->now.up);
  EXPECT_EQ(cell.world.count("000#8100"), 1U);
  EXPECT_EQ(cell.world.count("000#8103") + cell.world.count("000#8104"), 0U)
      << "one after the other disturbs";
  EXPECT_EQ(cell.link->done, (std::vector<std::string>{" down", " up type can bitrate 125000"}));
}

INSTANTIATE_TEST_SUITE_P(Families, BitrateOf, testing::Values("gsd600", "da200"),
                         [](const auto& family) { return std::string(family.param); });

TEST(BitrateSwitch, DrivesThatAreSwitchedOffAndOnAreWaitedForAtBothEnds) {
  BitrateCell cell("ts");
  const auto start = cell.world.bus.now();
  std::optional<std::uint32_t> when_off;
  cell.world.hooks.on_time = [&](TimePoint now) {
    const bool off = now >= start + 20s && now < start + 40s;
    if (now < start + 20s) return;
    for (auto& [node, rate] : cell.wire->rates) rate = off ? 0 : 125'000;
    if (off && !when_off) when_off = cell.bitrate();
  };
  const auto out = cell.run({.unlock = true, .patience = 60s});
  for (const auto& each : out)
    EXPECT_EQ(each.end, AddressEnd::at_bitrate) << (each.error ? each.error->message.text() : "");
  EXPECT_EQ(when_off, 250'000U) << "the interface stays while a drive is there";
  EXPECT_EQ(cell.bitrate(), 125'000U);
  for (const auto& frame : cell.world.sent) EXPECT_FALSE(frame.starts_with("000#8")) << frame;
}

TEST(BitrateSwitch, DrivesThatNobodySwitchesOffKeepTheInterfaceWithThem) {
  BitrateCell cell("ts");
  const auto out = cell.run({.unlock = true, .patience = 10s});
  ASSERT_TRUE(out[0].error);
  EXPECT_EQ(out[0].end, AddressEnd::awaits_restart);
  EXPECT_EQ(out[0].error->code, Errc::negative);
  EXPECT_NE(out[0].error->message.text().find("can0 stays at 250 kbit/s"), std::string::npos)
      << out[0].error->message.text();
  EXPECT_TRUE(cell.link->done.empty());
}

TEST(BitrateSwitch, CtrlCWhileTheyAreWaitedForLeavesTheInterface) {
  BitrateCell cell("ts");
  const auto start = cell.world.bus.now();
  cell.world.session->options().cancelled = [&] { return cell.world.bus.now() > start + 5s; };
  const auto out = cell.run({.unlock = true, .patience = 60s});
  ASSERT_TRUE(out[0].error);
  EXPECT_EQ(out[0].error->code, Errc::interrupted);
  EXPECT_TRUE(cell.link->done.empty());
}

TEST(BitrateSwitch, WhereNoneTookItTheInterfaceGoesBackToThem) {
  BitrateCell cell("gsd600");
  cell.wire->deaf = {3, 4};
  const auto out = cell.run();
  ASSERT_TRUE(out[0].error);
  EXPECT_EQ(out[0].end, AddressEnd::awaits_restart);
  EXPECT_NE(out[0].error->message.text().find("still answers at 250 kbit/s"), std::string::npos)
      << out[0].error->message.text();
  EXPECT_NE(out[0].error->hint.text().find("--wait 5min"), std::string::npos) << out[0].error->hint.text();
  EXPECT_EQ(cell.bitrate(), 250'000U);
  EXPECT_TRUE(cell.link->now.up);
}

TEST(BitrateSwitch, WhereNobodyAnswersAtEitherTheInterfaceStaysAtTheNewOne) {
  for (const bool refuses : {false, true}) {
    BitrateCell cell("gsd600");
    cell.wire->deaf = {3, 4};
    cell.world.hooks.on_time = [&](TimePoint) {
      if (cell.world.count("000#8100") > 0)
        for (auto& [node, rate] : cell.wire->rates) rate = 0;
    };
    int times = 0;
    if (refuses)
      cell.link->refuses = [&](const can::LinkChange& change) {
        return change.bitrate == 125'000U && ++times > 1 ? EINVAL : 0;
      };
    const auto out = cell.run();
    ASSERT_TRUE(out[0].error);
    EXPECT_EQ(out[0].end, AddressEnd::failed);
    EXPECT_EQ(out[0].error->code, Errc::timeout);
    EXPECT_NE(out[0].error->message.text().find("no drive answers at 125 kbit/s"), std::string::npos)
        << out[0].error->message.text();
    EXPECT_NE(out[0].error->hint.text().find(refuses ? "`bus status` shows" : "can0 has it now"),
              std::string::npos)
        << out[0].error->hint.text();
    EXPECT_EQ(cell.bitrate(), refuses ? 250'000U : 125'000U);
  }
}

TEST(BitrateSwitch, CtrlCBehindTheCommandIsHeardWhereTheInterfaceHasFollowed) {
  BitrateCell between("gsd600");
  between.world.session->options().cancelled = [&] {
    return between.world.count("000#8100") > 0 && between.bitrate() == 250'000U;
  };
  for (const auto& each : between.run()) EXPECT_EQ(each.end, AddressEnd::at_bitrate);
  BitrateCell behind("gsd600");
  behind.world.session->options().cancelled = [&] { return behind.bitrate() == 125'000U; };
  const auto out = behind.run();
  ASSERT_TRUE(out[0].error);
  EXPECT_EQ(out[0].error->code, Errc::interrupted);
  EXPECT_NE(out[0].error->message.text().find("can0 is at 125 kbit/s now; where the drives are was not seen"),
            std::string::npos)
      << out[0].error->message.text();
}

TEST(BitrateSwitch, OneThatIsMissingIsNamedAndTheOthersAreFound) {
  BitrateCell cell("gsd600");
  cell.wire->deaf = {4};
  const auto out = cell.run();
  EXPECT_EQ(out[0].end, AddressEnd::at_bitrate) << (out[0].error ? out[0].error->message.text() : "");
  ASSERT_TRUE(out[1].error);
  EXPECT_EQ(out[1].end, AddressEnd::failed);
  EXPECT_EQ(out[1].error->code, Errc::timeout);
  EXPECT_NE(out[1].error->message.text().find("no answer at 125 kbit/s"), std::string::npos)
      << out[1].error->message.text();
  EXPECT_EQ(cell.bitrate(), 125'000U) << "where most of them are";
}

TEST(BitrateSwitch, AnInterfaceThatCannotFollowSaysWhereTheDrivesAre) {
  BitrateCell cell("gsd600");
  cell.link->refuses = [](const can::LinkChange& change) { return change.bitrate == 125'000U ? EINVAL : 0; };
  const auto out = cell.run();
  ASSERT_TRUE(out[0].error);
  EXPECT_EQ(out[0].end, AddressEnd::failed);
  EXPECT_NE(
      out[0].error->message.text().find("the drives start at 125 kbit/s now, and can0 could not follow"),
      std::string::npos)
      << out[0].error->message.text();
  EXPECT_EQ(cell.bitrate(), 250'000U);
}

TEST(BitrateSwitch, DrivesThatHaveItForTheirNextStartAreOnlyRestarted) {
  BitrateCell cell("gsd600");
  for (const auto& change : cell.changes()) (void)change_address(cell.world.desk, change, {});
  cell.world.sent.clear();
  const auto all = cell.changes();
  for (const auto& change : all) EXPECT_TRUE(change.idle());
  auto follower = cell.plan(all);
  ASSERT_TRUE(follower.follows()) << follower.why_not;
  std::vector<AddressOutcome> out(2);
  follow_bitrate(cell.world.desk, follower, all, out, {});
  for (const auto& each : out)
    EXPECT_EQ(each.end, AddressEnd::at_bitrate) << (each.error ? each.error->message.text() : "");
  EXPECT_EQ(cell.world.count("000#8100"), 1U);
}

TEST(BitrateSwitch, ADriveWithABitrateForItsNextStartIsNotRestartedAloneToMove) {
  BitrateCell cell("gsd600");
  for (const auto& change : cell.changes()) (void)change_address(cell.world.desk, change, {});
  const auto change = plan_address(cell.world.desk, 3, {.node = 5, .bitrate = 125'000});
  ASSERT_TRUE(change) << change.error().message.text();
  EXPECT_EQ(change_address(cell.world.desk, *change, {}).end, AddressEnd::awaits_restart);
  EXPECT_EQ(cell.world.count("000#8103"), 0U);
}

TEST(BitrateSwitch, ADriveWithABitrateForItsNextStartIsNotMovedByItsNumberAlone) {
  BitrateCell cell("gsd600");
  for (const auto& change : cell.changes()) (void)change_address(cell.world.desk, change, {});
  cell.world.sent.clear();
  const auto change = plan_address(cell.world.desk, 3, {.node = 5, .bus_bitrate = 250'000});
  ASSERT_FALSE(change);
  EXPECT_EQ(change.error().code, Errc::refused);
  EXPECT_EQ(
      change.error().message.text(),
      "node 3, object 0x2000:31h: it starts at 125 kbit/s next, and its bus has 250 kbit/s: to move it is to start anew, and it "
      "would be gone");
  EXPECT_NE(change.error().hint.text().find("address --bitrate 250000 -n 3"), std::string::npos)
      << change.error().hint.text();
  for (const auto& frame : cell.world.sent) EXPECT_FALSE(frame.starts_with("603#2")) << frame;
  EXPECT_TRUE(plan_address(cell.world.desk, 3, {.node = 5, .bus_bitrate = 125'000})) << "it fits its bus";
  EXPECT_TRUE(plan_address(cell.world.desk, 3, {.node = 5, .bitrate = 125'000, .bus_bitrate = 250'000}))
      << "it is to go there";
  EXPECT_TRUE(plan_address(cell.world.desk, 3, {.node = 5})) << "nobody knows what the bus has";
}

TEST(BitrateSwitch, LeavesAnInterfaceAloneThatWouldLeaveSomebodyBehind) {
  BitrateCell cell("gsd600");
  const auto plan = cell.plan(cell.changes({3}));
  EXPECT_FALSE(plan.follows());
  EXPECT_NE(plan.why_not.find("node 4 would be left at 250 kbit/s"), std::string::npos) << plan.why_not;
}

TEST(BitrateSwitch, OneThatIsStoppedIsNotLeftBehindEither) {
  BitrateCell cell("gsd600", {3, 4, 5});
  (void)cell.world.session->wait([] { return false; }, cell.world.session->now() + 1s);
  (void)cell.world.bus.send(*can::parse_frame("000#0205"));
  const auto plan = cell.plan(cell.changes());
  EXPECT_FALSE(plan.follows());
  EXPECT_NE(plan.why_not.find("node 5 would be left at 250 kbit/s"), std::string::npos) << plan.why_not;
}

TEST(BitrateSwitch, DrivesThatWaitForTheirPowerNeedSomebodyWhoWaits) {
  BitrateCell cell("ts");
  const auto plan = cell.plan(cell.changes());
  EXPECT_FALSE(plan.follows());
  EXPECT_NE(plan.why_not.find("--wait"), std::string::npos) << plan.why_not;
}

TEST(BitrateSwitch, NeedsTheRightAndAnInterfaceWithABitrate) {
  BitrateCell cell("gsd600");
  const auto all = cell.changes();
  auto right = plan_switch(cell.world.desk, std::exchange(cell.owned, nullptr), all, 125'000, {}, false);
  ASSERT_TRUE(right);
  EXPECT_NE(right->why_not.find("CAP_NET_ADMIN"), std::string::npos) << right->why_not;
  auto same = plan_switch(cell.world.desk, std::move(right->link), all, 250'000, {}, true);
  ASSERT_TRUE(same);
  EXPECT_EQ(same->why_not, "it has 250 kbit/s already");
  auto state = session::controller(true);
  state.kind = "vcan";
  const auto none =
      plan_switch(cell.world.desk, std::make_unique<session::FakeLink>(state), all, 125'000, {}, true);
  ASSERT_TRUE(none);
  EXPECT_EQ(none->link, nullptr);
}

TEST(BitrateSwitch, SaysBeforeWhatItWillDo) {
  BitrateCell cell("gsd600");
  const auto all = cell.changes();
  const auto plan = cell.plan(all);
  EXPECT_EQ(switch_text(plan),
            "then all are restarted at once (NMT reset node), and can0 goes to 125 kbit/s (from 250 kbit/s, "
            "sample point 87.5 %)");
  EXPECT_EQ(
      switch_commands(plan),
      "000#8100 (NMT reset node to all), `ip link set can0 down`, `ip link set can0 up type can bitrate "
      "125000`");
}

}  // namespace
}  // namespace servoctl::settings
