#pragma once

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "can/bus.hpp"
#include "drive/naming.hpp"
#include "drive/profile.hpp"
#include "drive/standard_objects.hpp"
#include "session/session.hpp"
#include "session/wary.hpp"
#include "settings/address_change.hpp"
#include "sim/sim_bus.hpp"
#include "sim/sim_drive.hpp"
#include "tests/show/audiences.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::settings {

/// What happens on a bus beside what is sent.
struct BusHooks {
  std::function<void(const can::Frame&)> before_send = {};
  std::function<void(TimePoint)> on_time = {};
  bool lost = false;  ///< Nothing is sent or received any more.
};

class HookedBus final : public can::Bus {
 public:
  HookedBus(sim::SimBus& bus, BusHooks& hooks, std::vector<std::string>& sent)
      : bus_(&bus), hooks_(&hooks), sent_(&sent) {}

  TimePoint now() const override { return bus_->now(); }
  TimePoint next_event() const override { return bus_->next_event(); }
  Result<void> send(const can::Frame& frame) override {
    if (hooks_->before_send) hooks_->before_send(frame);
    if (hooks_->lost) return fail(Errc::bus, "can0 is down");
    sent_->push_back(can::to_string(frame));
    return bus_->send(frame);
  }
  Result<std::optional<can::Frame>> receive(TimePoint deadline) override {
    if (hooks_->on_time) hooks_->on_time(now());
    if (hooks_->lost) return fail(Errc::bus, "can0 is down");
    return bus_->receive(deadline);
  }

 private:
  sim::SimBus* bus_;
  BusHooks* hooks_;
  std::vector<std::string>* sent_;
};

/// Drives of a family on a bus, with a desk.
class AddressWorld {
 public:
  AddressWorld(const std::string& family, std::vector<std::uint8_t> nodes)
      : profile(drive::load_profile(family, kFolders).value()) {
    for (const auto node : nodes) add(node);
    restart_session();
  }
  sim::SimDrive& add(std::uint8_t node) { return add(node, profile); }
  /// Of another family, which outlives the world.
  sim::SimDrive& add(std::uint8_t node, const drive::Profile& family) {
    const auto key = std::to_string(drives.size() + 1);
    drives.push_back(std::make_unique<sim::SimDrive>(family, node, memory, key));
    bus.attach(*drives.back());
    if (session) session::be_wary_of_family(*session, node, family);
    return *drives.back();
  }
  /// Where an NMT reset is no restart: a drive with the memory of this one takes its place.
  void switch_off_and_on(std::size_t drive) {
    const auto node = static_cast<std::uint8_t>(drives[drive]->node());
    drives[drive]->fall_silent_at(bus.now());
    switched_off.push_back(std::move(drives[drive]));
    drives[drive] = std::make_unique<sim::SimDrive>(profile, node, memory, std::to_string(drive + 1));
    bus.attach(*drives[drive]);
  }
  void restart_session(std::unique_ptr<can::Bus> other = nullptr) {
    if (!other) other = std::make_unique<HookedBus>(bus, hooks, sent);
    session::Options network;
    network.drive_folders = [] { return std::span<const std::filesystem::path>(kFolders); };
    session = std::make_unique<session::Session>(std::move(other), "can0", std::move(network));
    // As each command of the program does.
    for (const auto& drive : drives)
      session::be_wary_of_family(*session, static_cast<std::uint8_t>(drive->node()), drive->profile());
    desk = {};
    desk.session = session.get();
    desk.profile = &profile;
    desk.audience = &willing;
  }
  std::uint64_t held(std::size_t drive, const std::string& name) const {
    return load_le(drives[drive]->value(*drive::place_of(profile, name)));
  }
  std::size_t count(const std::string& frame) const {
    return static_cast<std::size_t>(std::count(sent.begin(), sent.end(), frame));
  }
  std::string notices() const {
    std::string out;
    for (const auto& notice : desk.notices) out += notice.text() + "\n";
    return out;
  }

  drive::Profile profile;
  sim::Memory memory;
  sim::SimBus bus{sim::SimBus::Clock::virtual_time};
  std::vector<std::unique_ptr<sim::SimDrive>> drives;
  std::vector<std::unique_ptr<sim::SimDrive>> switched_off;
  BusHooks hooks;
  std::vector<std::string> sent;
  std::unique_ptr<session::Session> session;
  show::Willing willing;
  show::Desk desk;
};

inline AddressOutcome move_to(AddressWorld& world, std::uint8_t from, std::uint8_t to,
                              AddressOptions options = {}) {
  const auto change = plan_address(world.desk, from, {.node = to});
  EXPECT_TRUE(change) << change.error().message.text();
  if (!change) return {};
  return change_address(world.desk, *change, options);
}

inline bool is_write_to(const can::Frame& frame, ObjectAddress object) {
  return frame.id >= 0x600 && frame.id < 0x680 && (frame.data[0] & 0xE0U) == 0x20 &&
         frame.data[1] == (object.index & 0xFFU) && frame.data[2] == object.index >> 8U &&
         frame.data[3] == object.sub;
}

inline bool is_reset(const can::Frame& frame) { return frame.id == 0 && frame.data[0] >= 0x81; }

}  // namespace servoctl::settings
