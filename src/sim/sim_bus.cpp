#include "sim/sim_bus.hpp"

#include <algorithm>

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

TimePoint SimBus::now() const { return clock_.now(); }

Result<void> SimBus::send(const can::Frame& frame) {
  deliver(frame, nullptr);
  return {};
}

void SimBus::deliver(const can::Frame& frame, const Device* sender) {
  const auto time = now();
  for (auto* device : devices_)
    if (device != sender) device->on_frame(frame, time);
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
  const auto time = now();
  for (auto* device : devices_)
    if (device->deadline() <= time) device->on_time(time);
  collect();
}

TimePoint SimBus::next_event() const {
  if (!rx_.empty()) return now();
  TimePoint next = kNever;
  for (auto* device : devices_) next = std::min(next, device->deadline());
  return next;
}

Result<std::optional<can::Frame>> SimBus::receive(TimePoint deadline) {
  for (;;) {
    run_devices();
    if (!rx_.empty()) {
      clock_.move_on(kFrameTime);
      const auto frame = rx_.front();
      rx_.pop_front();
      return std::optional(frame);
    }
    const auto wake = std::min(next_event(), deadline);
    if (!clock_.wait_until(wake)) return std::optional<can::Frame>{};
    if (wake == deadline && next_event() > deadline) return std::optional<can::Frame>{};
  }
}

}  // namespace servoctl::sim
