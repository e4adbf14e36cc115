#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "sim/can_port.hpp"
#include "sim/device.hpp"
#include "sim/drive_model.hpp"

namespace servoctl::sim {

/// A drive of a family on CAN: a drive model with a CAN port around it.
class SimDrive final : public Device {
 public:
  /// As DriveModel's.
  SimDrive(const drive::Profile& profile, std::uint8_t node, Memory& memory, std::string key)
      : model_(profile, node, memory, std::move(key)), port_(model_) {}

  void on_frame(const can::Frame& frame, TimePoint now) override { port_.on_frame(frame, now); }
  void on_time(TimePoint now) override { port_.on_time(now); }
  std::optional<can::Frame> take_frame() override { return port_.take_frame(); }
  TimePoint deadline() const override { return port_.deadline(); }

  DriveModel& model() { return model_; }

  /// As DriveModel's, and told at once.
  void raise_fault(std::uint16_t code, std::array<std::uint8_t, 5> vendor, TimePoint now) {
    model_.raise_fault(code, vendor, now);
    port_.collect_emergencies(now);
  }
  /// It answers LSS, and has this serial number from its start on.
  void enable_lss(std::uint32_t serial) {
    model_.set_serial(serial);
    port_.enable_lss();
  }
  void raise_fault_at(Alarm alarm, TimePoint time) { model_.raise_fault_at(alarm, time); }
  void fall_silent_at(TimePoint time) { port_.fall_silent_at(time); }
  Misbehaviour& misbehaviour() { return model_.misbehaviour(); }
  WireFaults& wire_faults() { return port_.faults(); }
  void set_torque_off(bool off) { model_.set_torque_off(off); }
  AxisFaults& axis_faults() { return model_.axis_faults(); }
  Track& track() { return model_.track(); }
  std::map<std::string, std::int64_t, std::less<>>& panel() { return model_.panel(); }
  double& own_counts() { return model_.own_counts(); }

  const drive::Profile& profile() const { return model_.profile(); }
  std::uint8_t node() const { return model_.node(); }
  canopen::NmtState nmt_state() const { return port_.nmt_state(); }
  drive::DriveState power_state() const { return model_.power_state(); }
  bool is_moving() const { return model_.is_moving(); }
  /// What an object holds, as its bytes; for tests that look past the bus.
  const Bytes& value(ObjectAddress object) const { return model_.values().get(object); }
  std::uint64_t flash_writes() const { return model_.flash_writes(); }

 private:
  DriveModel model_;
  CanPort port_;
};

}  // namespace servoctl::sim
