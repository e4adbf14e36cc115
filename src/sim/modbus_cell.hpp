#pragma once

#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "base/time.hpp"
#include "modbus/framing.hpp"
#include "sim/memory.hpp"
#include "sim/modbus_unit.hpp"

namespace servoctl::sim {

/// How units deviate from the standard (`lie=`); all off at first.
struct ModbusLies {
  bool late = false;         ///< `late`: every second answer comes 700 ms late.
  bool twice = false;        ///< `twice`: every answer comes twice.
  bool is_short = false;     ///< `short`: the last byte of the PDU is missing.
  bool unconfirmed = false;  ///< `unconfirmed`: writes are done and not answered.
  bool busy = false;         ///< `busy`: two of three requests are refused with exception 06h.
};

/// Simulated drives on a Modbus line with all that belongs to them. Performs no I/O and reads no clock.
struct ModbusCell {
  std::vector<std::shared_ptr<const drive::Profile>> profiles;  ///< One a family.
  std::unique_ptr<Memory> memory;
  std::vector<std::unique_ptr<ModbusUnit>> units;
  ModbusLies lies;
  unsigned damage = 0;  ///< Every so manieth answer has a wrong bit; 0: none.
  unsigned answered = 0;
  TimePoint last_answer{};  ///< No answer overtakes another.

  /// What one of them answers, and when it does; empty where nobody answers.
  struct Answer {
    Bytes bytes;  ///< As they stand on the wire.
    TimePoint time;
  };
  std::optional<Answer> on_message(modbus::Framing framing, const modbus::Message& message, TimePoint now);
  void on_time(TimePoint now);
  TimePoint deadline() const;
};

/// Builds drives from `ts@1,ts@2?state=FILE&fault=0xFF00@2s&silent=5s&delay=20ms&damage=10&lie=late`:
/// families with [modbus] rules and their unit addresses; options as build_cell()'s. They have power from
/// `now` on. Errc::usage for what is wrong in the text.
Result<ModbusCell> build_modbus_cell(std::string_view text, std::span<const std::filesystem::path> folders,
                                     TimePoint now);

}  // namespace servoctl::sim
