#pragma once

#include <gtest/gtest.h>

#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>

#include "canopen/nmt.hpp"
#include "drive/naming.hpp"
#include "motion/motion_kinds.hpp"
#include "session/can_network.hpp"
#include "session/wary.hpp"
#include "sim/cell.hpp"
#include "tests/session/troubled_bus.hpp"
#include "tests/sim/commissioned.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::motion {

/// A bus in virtual time whose drive a test can look at, and that can be lost at any frame.
class MotionBus final : public can::Bus {
 public:
  explicit MotionBus(std::string_view spec) {
    const std::filesystem::path folders[] = {std::filesystem::path(source_dir()) / "eds"};
    cell = sim::build_cell(spec, folders, bus.now()).value();
    sim::commission(cell);
    for (const auto& drive : cell.drives) bus.attach(*drive);
  }
  TimePoint now() const override { return bus.now(); }
  Result<void> send(const can::Frame& frame) override {
    ++sent;
    if (outage.covers(now())) return fail(Errc::bus, "vcan0 went down");
    if (on_sent) on_sent(frame);
    if (sent > lost_after) return fail(Errc::bus, "vcan0 went down");
    frames.push_back(can::to_string(frame));
    if (frame.id == 0x77F) last_heartbeat = now();
    if (swallows && swallows(frames.back())) return {};
    return bus.send(frame);
  }
  Result<std::optional<can::Frame>> receive(TimePoint deadline) override {
    if (!injected.empty()) {
      auto first = can::parse_frame(injected.front());
      injected.pop_front();
      return first;
    }
    if (outage.covers(now())) return fail(Errc::bus, "vcan0 went down");
    auto frame = bus.receive(deadline);
    if (frame && *frame && alter) alter(**frame);
    return frame;
  }
  TimePoint next_event() const override { return bus.next_event(); }
  Result<void> recover(TimePoint deadline) override {
    if (sent > lost_after) return fail(Errc::bus, "vcan0 is down");
    return outage.pass(bus, deadline);
  }

  session::Outage outage;
  std::function<void(const can::Frame&)> on_sent;
  sim::SimBus bus{sim::SimBus::Clock::virtual_time};
  sim::Cell cell;
  std::vector<std::string> frames;
  int sent = 0;
  int lost_after = 1'000'000'000;
  TimePoint last_heartbeat{};                              ///< Of servoctl as node 127.
  std::function<bool(const std::string& frame)> swallows;  ///< Whether a frame never reaches the drive.
  std::deque<std::string> injected;                        ///< Frames that seem to arrive.
  std::function<void(can::Frame&)> alter;                  ///< What servoctl hears instead.
};

inline Jog jog_for(std::string speed, Duration length) {
  Jog out;
  out.speed = std::move(speed);
  out.length = length;
  return out;
}
inline Jog jog_turns(std::string speed, double turns) {
  Jog out;
  out.speed = std::move(speed);
  out.turns = turns;
  return out;
}
inline Move move_to(std::string target, std::string speed, bool relative = false) {
  Move out;
  out.target = std::move(target);
  out.speed = std::move(speed);
  out.relative = relative;
  return out;
}
inline Home home_by(std::string method, Duration longest = std::chrono::seconds(60)) {
  Home out;
  out.method = std::move(method);
  out.fast = "60rpm";
  out.slow = "60rpm";
  out.longest = longest;
  return out;
}

/// One motion of a simulated drive, and what it leaves behind.
class MotionBench {
 public:
  explicit MotionBench(std::string_view family, double turn = 0) {
    auto owned = std::make_unique<MotionBus>(std::string(family) + "@1");
    bus = owned.get();
    session::Options network;
    network.drive_folders = [] { return std::span<const std::filesystem::path>(kFolders); };
    session = std::make_unique<session::Session>(std::move(owned), "test", std::move(network));
    EXPECT_TRUE(session->listen());
    (void)session->take_events();
    session::be_wary_of_family(*session, 1, profile());  // As each command of the program does.
    if (turn > 0) options.turn = turn;
  }

  sim::SimDrive& drive() { return *bus->cell.drives.front(); }
  const drive::Profile& profile() { return *bus->cell.profiles.front(); }

  template <class Kind>
  MotionReport run(const Kind& kind, Result<MotionPlan> (*plan)(Motion&, const Kind&),
                   MotionReport (*go)(Motion&, const Kind&, const MotionPlan&)) {
    MotionReport out;
    Motion motion(*session, profile(), 1, options);
    if (const auto ready = motion.prepare(); !ready) return failed(ready.error());
    if (const auto found = motion.find_watchdog(); !found) return failed(found.error());
    const auto made = plan(motion, kind);
    if (!made) return failed(made.error());
    before = objects();
    if (started) started();
    return go(motion, kind, *made);
  }
  MotionReport jog(const Jog& kind) { return run(kind, plan_jog, run_jog); }
  MotionReport move(const Move& kind) { return run(kind, plan_move, run_move); }
  MotionReport home(const Home& kind) { return run(kind, plan_home, run_home); }
  MotionReport torque(const Torque& kind) { return run(kind, plan_torque, run_torque); }

  /// Every value a master can set, but the controlword and what homing is for.
  std::map<std::string, Bytes> objects() {
    std::map<std::string, Bytes> out;
    for (const auto& object : profile().dictionary.objects())
      for (const auto& entry : object.entries)
        if (entry.access == od::Access::rw && entry.address.index != 0x6040)
          out[to_string(entry.address)] = drive().value(entry.address);
    return out;
  }

  /// Those that are not as they were before the motion.
  std::vector<std::string> changed() {
    std::vector<std::string> out;
    for (const auto& [name, bytes] : objects())
      if (bytes != before[name]) out.push_back(name + " " + to_hex(before[name]) + " -> " + to_hex(bytes));
    return out;
  }

  /// Lets time pass with nobody on the bus.
  void wait(Duration time) {
    (void)session->wait([] { return false; }, session->now() + time);
  }

  /// As an installer leaves it: the drive acts on its limit switches. It has restarted where that needs it.
  void obey_switches() {
    bool restarts = false;
    for (const auto& rule : profile().rules.cautions) {
      if (rule.masks.empty() || !rule.set) continue;
      const auto place = drive::place_of(profile(), rule.name);
      if (!place) {
        drive().panel()[rule.name] = *rule.set;
        options.panel[rule.name] = *rule.set;
        continue;
      }
      const auto size = drive().value(*place).size();
      EXPECT_TRUE(session->download(1, *place, store_le(static_cast<std::uint64_t>(*rule.set), size)));
      restarts = true;
    }
    if (!restarts) return;
    EXPECT_TRUE(session->can()->send(canopen::nmt_frame(canopen::NmtCommand::reset_node, 1)));
    wait(std::chrono::milliseconds(500));
    (void)session->take_events();
  }

  bool energised() { return drive::is_energised(drive().power_state()); }

  MotionOptions options;
  MotionBus* bus = nullptr;
  std::unique_ptr<session::Session> session;
  std::map<std::string, Bytes> before;
  std::function<void()> started;  ///< Called when the plan is made.

 private:
  static MotionReport failed(const Error& error) {
    MotionReport out;
    out.outcome = fail(error);
    return out;
  }
};

/// Something goes wrong with the bench's drive.
class MotionTrouble : public testing::Test {
 protected:
  void expect_stopped(const MotionReport& done, std::string_view reason) {
    ASSERT_FALSE(done.outcome);
    EXPECT_NE(done.outcome.error().message.text().find(reason), std::string::npos)
        << done.outcome.error().message.text();
    EXPECT_TRUE(done.end.verified);
    EXPECT_FALSE(bench.energised());
    EXPECT_EQ(bench.changed(), std::vector<std::string>{});
  }

  MotionBench bench{"gsd600", 131072};
  const Jog kJog = jog_for("60rpm", std::chrono::seconds(10));
};

}  // namespace servoctl::motion
