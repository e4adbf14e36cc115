#include "sim/sim_bus.hpp"

#include <algorithm>

#include "base/signal_wait.hpp"

namespace servoctl::sim {
namespace {

/// A frame of 8 bytes takes about this long at 1 Mbit/s; virtual time moves on by it with every frame
/// received.
constexpr Duration kFrameTime{120};

}  // namespace

void SimBus::attach(Device& device) {
  device.on_time(now());
  devices_.push_back(&device);
  collect();
}

TimePoint SimBus::now() const { return clock_ == Clock::real_time ? steady_now() : virtual_now_; }

Result<void> SimBus::send(const can::Frame& frame) {
  deliver(frame, nullptr);
  return {};
}

void SimBus::deliver(const can::Frame& frame, const Device* sender) {
  for (auto* device : devices_)
    if (device != sender) device->on_frame(frame, now());
  collect();
}

void SimBus::collect() {
  for (auto* device : devices_) {
    while (const auto frame = device->take_frame()) {
      rx_.push_back(*frame);
      deliver(*frame, device);
    }
  }
}

void SimBus::run_devices() {
  for (auto* device : devices_)
    if (device->deadline() <= now()) device->on_time(now());
  collect();
}

TimePoint SimBus::next_event() const {
  if (!rx_.empty()) return now();
  TimePoint next = kNever;
  for (auto* device : devices_) next = std::min(next, device->deadline());
  return next;
}

bool SimBus::wait_until(TimePoint time) {
  if (clock_ == Clock::virtual_time) {
    virtual_now_ = std::max(virtual_now_, time);
    return true;
  }
  const auto left = time - steady_now();
  if (left <= Duration::zero()) return true;
  return wait_or_signal({}, std::min<Duration>(left, std::chrono::hours(1))) == 0;
}

Result<std::optional<can::Frame>> SimBus::receive(TimePoint deadline) {
  for (;;) {
    run_devices();
    if (!rx_.empty()) {
      if (clock_ == Clock::virtual_time) virtual_now_ += kFrameTime;
      const auto frame = rx_.front();
      rx_.pop_front();
      return std::optional(frame);
    }
    const auto wake = std::min(next_event(), deadline);
    if (!wait_until(wake)) return std::optional<can::Frame>{};
    if (wake == deadline && next_event() > deadline) return std::optional<can::Frame>{};
  }
}

}  // namespace servoctl::sim
