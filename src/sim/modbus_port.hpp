#pragma once

#include <deque>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>
#include <utility>

#include "modbus/port.hpp"
#include "sim/modbus_cell.hpp"
#include "sim/sim_clock.hpp"

namespace servoctl::sim {

/// A line in this process with simulated drives on it, of 115200 bit/s in RTU frames.
class ModbusSimPort final : public modbus::Port {
 public:
  ModbusSimPort(ModbusCell cell, SimClock clock)
      : cell_(std::move(cell)),
        clock_(clock),
        in_(modbus::Framing::rtu, modbus::Deframer::Expects::requests) {}

  modbus::Framing framing() const override { return modbus::Framing::rtu; }
  Duration silence() const override { return Duration(1750); }
  TimePoint now() const override { return clock_.now(); }
  Result<void> send(ByteSpan bytes) override;
  Result<Bytes> receive(TimePoint deadline) override;
  Result<void> reopen(TimePoint) override { return {}; }
  TimePoint next_event() const override { return answers_.empty() ? kNever : answers_.front().time; }

 private:
  ModbusCell cell_;
  SimClock clock_;
  modbus::Deframer in_;
  std::deque<ModbusCell::Answer> answers_;
};

/// Errors as build_modbus_cell().
Result<std::unique_ptr<modbus::Port>> open_modbus_sim(std::string_view text,
                                                      std::span<const std::filesystem::path> folders,
                                                      SimClock::Kind clock);

}  // namespace servoctl::sim
