#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/bytes.hpp"
#include "modbus/pdu.hpp"
#include "sim/drive_model.hpp"

namespace servoctl::sim {

/// A drive of a family with [modbus] rules on a line: a drive model whose objects are registers. Reads and
/// writes of holding registers (03h, 06h, 10h) and reads of its inputs and outputs (02h, 01h); anything else
/// is an illegal function. A drive without a connected encoder, load or cabling: its inputs and outputs are
/// off, and its internal modes do not turn the motor.
class ModbusUnit {
 public:
  /// As DriveModel's. In a fresh memory the parameter of the unit address has `unit`; one that is kept there
  /// is the address from power-on on.
  ModbusUnit(const drive::Profile& profile, std::uint8_t unit, Memory& memory, const std::string& key);

  void power_on(TimePoint now);
  /// The PDU of the answer; empty where there is none. `to_all`: it was sent to unit 0.
  std::optional<Bytes> on_request(ByteSpan pdu, bool to_all, TimePoint now);

  std::uint8_t unit() const { return unit_; }
  DriveModel& model() { return model_; }
  Duration delay() const { return delay_; }
  void set_delay(Duration delay) { delay_ = delay; }
  void fall_silent_at(TimePoint time) { silent_from_ = time; }

 private:
  Bytes answer(ByteSpan pdu);
  Bytes read_bits(ByteSpan pdu, std::uint16_t there);
  Bytes read_registers(ByteSpan pdu);
  Bytes write_one(ByteSpan pdu);
  Bytes write_many(ByteSpan pdu);
  /// 0, or why not.
  std::uint8_t write(std::uint16_t address, std::uint16_t value);

  DriveModel model_;
  std::uint8_t unit_;
  Duration delay_ = std::chrono::milliseconds(2);
  TimePoint silent_from_ = kNever;
};

}  // namespace servoctl::sim
