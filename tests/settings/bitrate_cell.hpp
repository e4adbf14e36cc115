#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "settings/bitrate_switch.hpp"
#include "tests/session/fake_link.hpp"
#include "tests/settings/address_world.hpp"

namespace servoctl::settings {

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

/// Drives at 250 kbit/s, and an interface that can go with them.
struct BitrateCell {
  explicit BitrateCell(const std::string& family, std::vector<std::uint8_t> nodes = {3, 4})
      : world(family, nodes) {
    auto bus = std::make_unique<TunedWire>(world, link);
    wire = bus.get();
    for (const auto node : nodes) wire->rates[node] = 250'000;
    world.restart_session(std::move(bus));
  }

  std::vector<AddressChange> changes(const std::vector<std::uint8_t>& nodes = {3, 4}) {
    std::vector<AddressChange> out;
    for (const auto node : nodes) {
      auto change = plan_address(world.desk, node, {.bitrate = 125'000});
      EXPECT_TRUE(change) << change.error().message.text();
      if (change) out.push_back(std::move(*change));
    }
    return out;
  }
  BitrateSwitch plan(std::span<const AddressChange> all, AddressOptions options = {}) {
    auto plan = plan_switch(world.desk, std::exchange(owned, nullptr), all, 125'000, options, true);
    EXPECT_TRUE(plan) << plan.error().message.text();
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

}  // namespace servoctl::settings
