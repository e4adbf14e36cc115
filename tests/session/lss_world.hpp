#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "session/lss.hpp"
#include "session/session.hpp"
#include "sim/cell.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::session {

/// What becomes of frames of LSS between servoctl and the drives, counted from 0 in the order they pass.
struct LssHooks {
  int lose_request = -1;
  int lose_answer = -1;
  std::function<void(can::Frame&)> change_answer = {};
  std::function<void(can::Frame&)> change_request = {};
  std::function<void(int request)> before_request = {};
  std::function<void()> after_request = {};
  bool comes_back = false;  ///< When it is asked to.
  int requests = 0;
  int answers = 0;
};

class LssBus final : public can::Bus {
 public:
  LssBus(sim::SimBus& bus, LssHooks& hooks) : bus_(&bus), hooks_(&hooks) {}
  TimePoint now() const override { return bus_->now(); }
  TimePoint next_event() const override { return bus_->next_event(); }
  Result<void> send(const can::Frame& frame) override {
    if (frame.id != canopen::kLssRequest) return bus_->send(frame);
    const int number = hooks_->requests++;
    if (hooks_->before_request) hooks_->before_request(number);
    auto changed = frame;
    if (hooks_->change_request) hooks_->change_request(changed);
    const auto sent = number == hooks_->lose_request ? Result<void>() : bus_->send(changed);
    if (hooks_->after_request) hooks_->after_request();
    return sent;
  }
  Result<void> recover(TimePoint deadline) override {
    return hooks_->comes_back ? Result<void>() : can::Bus::recover(deadline);
  }
  Result<std::optional<can::Frame>> receive(TimePoint deadline) override {
    for (;;) {
      auto frame = bus_->receive(deadline);
      if (!frame || !*frame || (*frame)->id != canopen::kLssAnswer) return frame;
      if (hooks_->answers++ == hooks_->lose_answer) continue;
      if (hooks_->change_answer) hooks_->change_answer(**frame);
      return frame;
    }
  }

 private:
  sim::SimBus* bus_;
  LssHooks* hooks_;
};

/// Simulated drives with LSS, and a session on their bus.
class LssWorld : public testing::Test {
 protected:
  void build(std::string_view spec) {
    cell = sim::build_cell(spec, kFolders, bus.now()).value();
    for (const auto& drive : cell.drives) bus.attach(*drive);
    session = std::make_unique<Session>(std::make_unique<LssBus>(bus, hooks), "can0", Options{});
    (void)session->wait([] { return false; }, session->now() + std::chrono::seconds(1));
  }
  /// Whether nobody takes what is configured: asked past the session.
  bool all_wait() {
    while (*bus.receive(bus.now())) {
    }
    (void)bus.send(canopen::lss_inquire(canopen::LssService::inquire_node).frames.front());
    const auto answer = bus.receive(bus.now() + std::chrono::milliseconds(10));
    return answer && (!*answer || (*answer)->id != canopen::kLssAnswer);
  }
  /// As it sees itself, without the bus.
  static canopen::LssAddress address(const sim::SimDrive& drive) {
    const auto number = [&](std::uint8_t sub) {
      return static_cast<std::uint32_t>(load_le(drive.value({0x1018, sub})));
    };
    return {number(1), number(2), number(3), number(4)};
  }

  sim::Cell cell;
  sim::SimBus bus{sim::SimBus::Clock::virtual_time};
  LssHooks hooks;
  std::unique_ptr<Session> session;
};

}  // namespace servoctl::session
