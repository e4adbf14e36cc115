#pragma once

#include <deque>
#include <vector>

#include "can/bus.hpp"
#include "sim/device.hpp"
#include "sim/sim_clock.hpp"

namespace servoctl::sim {

/// A bus inside this process, with its devices. With the virtual clock every wait ends at once and costs no
/// real time; with the real clock it behaves like a bus of hardware.
class SimBus final : public can::Bus {
 public:
  using Clock = SimClock::Kind;

  explicit SimBus(Clock clock) : clock_(clock) {}

  /// Puts a device, which outlives the bus, on it; what it has to say at once (boot-up) is received first.
  void attach(Device& device);

  TimePoint now() const override;
  Result<void> send(const can::Frame& frame) override;
  Result<std::optional<can::Frame>> receive(TimePoint deadline) override;
  TimePoint next_event() const override;

 private:
  /// Hands a frame to all devices but the sender (may be null), then what they answer, until all are silent.
  void deliver(const can::Frame& frame, const Device* sender);
  void collect();
  void run_devices();

  SimClock clock_;
  std::vector<Device*> devices_;
  std::deque<can::Frame> rx_;
};

}  // namespace servoctl::sim
