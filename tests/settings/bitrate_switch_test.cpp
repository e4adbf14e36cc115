// Drives and the interface of their bus go to another bitrate together: nobody is left behind, and where it
// fails the error says where everybody is.
#include "settings/bitrate_switch.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/session/fake_link.hpp"
#include "tests/settings/address_world.hpp"

namespace servoctl::settings {
namespace {

using namespace std::chrono_literals;

/// A wire on which nodes at another bitrate than the interface hear nothing, and are not heard.
class TunedWire final : public can::Bus {
 public:
  TunedWire(AddressWorld& world, session::FakeLink*& link) : world_(&world), link_(&link) {}

  TimePoint now() const override { return world_->bus.now(); }
  TimePoint next_event() const override { return world_->bus.next_event(); }
  Result<void> send(const can::Frame& frame) override {
    if (!(*link_)->now.up) return fail(Errc::bus, "can0 is down");
    world_->sent.push_back(can::to_string(frame));
    const bool command = frame.id == 0;
    if (!command && !hears(static_cast<std::uint8_t>(frame.id & 0x7FU))) return {};
    const auto sent = world_->bus.send(frame);
    if (is_reset(frame)) after_reset();
    return sent;
  }
  Result<std::optional<can::Frame>> receive(TimePoint deadline) override {
    if (world_->hooks.on_time) world_->hooks.on_time(now());
    for (;;) {
      auto frame = world_->bus.receive(deadline);
      if (!frame || !*frame) return frame;
      if ((*link_)->now.up && hears(static_cast<std::uint8_t>((*frame)->id & 0x7FU))) return frame;
    }
  }
  Result<void> recover(TimePoint) override {
    return (*link_)->now.up ? Result<void>() : fail(Errc::bus, "can0 is down");
  }

  std::map<std::uint8_t, std::uint32_t> rates;  ///< By node; 0: it is off.
  std::set<std::uint8_t> deaf;                  ///< A reset is not heard.

 private:
  bool hears(std::uint8_t node) const {
    return rates.count(node) > 0 && rates.at(node) == (*link_)->now.bitrate;
  }
  void after_reset() {
    for (auto& [node, rate] : rates)
      if (deaf.count(node) == 0) rate = 125'000;
  }

  AddressWorld* world_;
  session::FakeLink** link_;
};

struct Cell {
  explicit Cell(const std::string& family, std::vector<std::uint8_t> nodes = {3, 4}) : world(family, nodes) {
    auto bus = std::make_unique<TunedWire>(world, link);
    wire = bus.get();
    for (const auto node : nodes) wire->rates[node] = 250'000;
    world.restart_session(std::move(bus));
  }

  std::vector<AddressChange> changes(const std::vector<std::uint8_t>& nodes = {3, 4}) {
    std::vector<AddressChange> out;
    for (const auto node : nodes) {
      auto change = plan_address(world.desk, node, {.bitrate = 125'000});
      EXPECT_TRUE(change) << change.error().message;
      if (change) out.push_back(std::move(*change));
    }
    return out;
  }
  BitrateSwitch plan(std::span<const AddressChange> all, AddressOptions options = {}) {
    auto plan = plan_switch(world.desk, std::exchange(owned, nullptr), all, 125'000, options, true);
    EXPECT_TRUE(plan) << plan.error().message;
    return plan ? std::move(*plan) : BitrateSwitch{};
  }
  std::vector<AddressOutcome> run(AddressOptions options = {}) {
    const auto all = changes();
    auto follower = plan(all, options);
    EXPECT_TRUE(follower.follows()) << follower.why_not;
    std::vector<AddressOutcome> out;
    for (const auto& change : all) out.push_back(change_address(world.desk, change, options));
    for (const auto& each : out) EXPECT_EQ(each.end, AddressEnd::awaits_restart);
    follow_bitrate(world.desk, follower, all, out, options);
    kept = std::move(follower.link);
    return out;
  }
  std::uint32_t bitrate() const { return link->now.bitrate.value_or(0); }

  std::unique_ptr<session::FakeLink> owned =
      std::make_unique<session::FakeLink>(session::controller(true, 250'000));
  session::FakeLink* link = owned.get();
  std::unique_ptr<can::LinkControl> kept;
  AddressWorld world;
  TunedWire* wire = nullptr;
};

class BitrateOf : public testing::TestWithParam<const char*> {};

TEST_P(BitrateOf, DrivesAreRestartedByOneCommandAndFoundAtTheNewBitrate) {
  Cell cell(GetParam());
  const auto out = cell.run();
  ASSERT_EQ(out.size(), 2U);
  for (const auto& each : out) {
    EXPECT_EQ(each.end, AddressEnd::at_bitrate) << (each.error ? each.error->message : "");
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
  Cell cell("ts");
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
    EXPECT_EQ(each.end, AddressEnd::at_bitrate) << (each.error ? each.error->message : "");
  EXPECT_EQ(when_off, 250'000U) << "the interface stays while a drive is there";
  EXPECT_EQ(cell.bitrate(), 125'000U);
  for (const auto& frame : cell.world.sent) EXPECT_FALSE(frame.starts_with("000#8")) << frame;
}

TEST(BitrateSwitch, DrivesThatNobodySwitchesOffKeepTheInterfaceWithThem) {
  Cell cell("ts");
  const auto out = cell.run({.unlock = true, .patience = 10s});
  ASSERT_TRUE(out[0].error);
  EXPECT_EQ(out[0].end, AddressEnd::awaits_restart);
  EXPECT_EQ(out[0].error->code, Errc::negative);
  EXPECT_NE(out[0].error->message.find("can0 stays at 250 kbit/s"), std::string::npos)
      << out[0].error->message;
  EXPECT_TRUE(cell.link->done.empty());
}

TEST(BitrateSwitch, CtrlCWhileTheyAreWaitedForLeavesTheInterface) {
  Cell cell("ts");
  const auto start = cell.world.bus.now();
  cell.world.session->options().cancelled = [&] { return cell.world.bus.now() > start + 5s; };
  const auto out = cell.run({.unlock = true, .patience = 60s});
  ASSERT_TRUE(out[0].error);
  EXPECT_EQ(out[0].error->code, Errc::interrupted);
  EXPECT_TRUE(cell.link->done.empty());
}

TEST(BitrateSwitch, WhereNoneTookItTheInterfaceGoesBackToThem) {
  Cell cell("gsd600");
  cell.wire->deaf = {3, 4};
  const auto out = cell.run();
  ASSERT_TRUE(out[0].error);
  EXPECT_EQ(out[0].end, AddressEnd::awaits_restart);
  EXPECT_NE(out[0].error->message.find("still answers at 250 kbit/s"), std::string::npos)
      << out[0].error->message;
  EXPECT_EQ(cell.bitrate(), 250'000U);
  EXPECT_TRUE(cell.link->now.up);
}

TEST(BitrateSwitch, OneThatIsMissingIsNamedAndTheOthersAreFound) {
  Cell cell("gsd600");
  cell.wire->deaf = {4};
  const auto out = cell.run();
  EXPECT_EQ(out[0].end, AddressEnd::at_bitrate) << (out[0].error ? out[0].error->message : "");
  ASSERT_TRUE(out[1].error);
  EXPECT_EQ(out[1].end, AddressEnd::failed);
  EXPECT_EQ(out[1].error->code, Errc::timeout);
  EXPECT_NE(out[1].error->message.find("no answer at 125 kbit/s"), std::string::npos)
      << out[1].error->message;
  EXPECT_EQ(cell.bitrate(), 125'000U) << "where most of them are";
}

TEST(BitrateSwitch, AnInterfaceThatCannotFollowSaysWhereTheDrivesAre) {
  Cell cell("gsd600");
  cell.link->refuses = [](const can::LinkChange& change) { return change.bitrate == 125'000U ? EINVAL : 0; };
  const auto out = cell.run();
  ASSERT_TRUE(out[0].error);
  EXPECT_EQ(out[0].end, AddressEnd::failed);
  EXPECT_NE(out[0].error->message.find("the drives start at 125 kbit/s now, and can0 could not follow"),
            std::string::npos)
      << out[0].error->message;
  EXPECT_EQ(cell.bitrate(), 250'000U);
}

TEST(BitrateSwitch, DrivesThatHaveItForTheirNextStartAreOnlyRestarted) {
  Cell cell("gsd600");
  for (const auto& change : cell.changes()) (void)change_address(cell.world.desk, change, {});
  cell.world.sent.clear();
  const auto all = cell.changes();
  for (const auto& change : all) EXPECT_TRUE(change.idle());
  auto follower = cell.plan(all);
  ASSERT_TRUE(follower.follows()) << follower.why_not;
  std::vector<AddressOutcome> out(2);
  follow_bitrate(cell.world.desk, follower, all, out, {});
  for (const auto& each : out)
    EXPECT_EQ(each.end, AddressEnd::at_bitrate) << (each.error ? each.error->message : "");
  EXPECT_EQ(cell.world.count("000#8100"), 1U);
}

TEST(BitrateSwitch, ADriveWithABitrateForItsNextStartIsNotRestartedAloneToMove) {
  Cell cell("gsd600");
  for (const auto& change : cell.changes()) (void)change_address(cell.world.desk, change, {});
  const auto change = plan_address(cell.world.desk, 3, {.node = 5, .bitrate = 125'000});
  ASSERT_TRUE(change) << change.error().message;
  EXPECT_EQ(change_address(cell.world.desk, *change, {}).end, AddressEnd::awaits_restart);
  EXPECT_EQ(cell.world.count("000#8103"), 0U);
}

TEST(BitrateSwitch, LeavesAnInterfaceAloneThatWouldLeaveSomebodyBehind) {
  Cell cell("gsd600");
  const auto plan = cell.plan(cell.changes({3}));
  EXPECT_FALSE(plan.follows());
  EXPECT_NE(plan.why_not.find("node 4 would be left at 250 kbit/s"), std::string::npos) << plan.why_not;
}

TEST(BitrateSwitch, DrivesThatWaitForTheirPowerNeedSomebodyWhoWaits) {
  Cell cell("ts");
  const auto plan = cell.plan(cell.changes());
  EXPECT_FALSE(plan.follows());
  EXPECT_NE(plan.why_not.find("--wait"), std::string::npos) << plan.why_not;
}

TEST(BitrateSwitch, NeedsTheRightAndAnInterfaceWithABitrate) {
  Cell cell("gsd600");
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
  Cell cell("gsd600");
  const auto all = cell.changes();
  const auto plan = cell.plan(all);
  EXPECT_EQ(switch_text(plan, all.front()),
            "then all are restarted at once (NMT reset node), and can0 goes to 125 kbit/s (from 250 kbit/s, "
            "sample point 87.5 %)");
  EXPECT_EQ(
      switch_commands(plan, all.front()),
      "000#8100 (NMT reset node to all), `ip link set can0 down`, `ip link set can0 up type can bitrate "
      "125000`");
}

}  // namespace
}  // namespace servoctl::settings
