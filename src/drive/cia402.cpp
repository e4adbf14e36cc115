#include "drive/cia402.hpp"

#include <algorithm>
#include <array>
#include <iterator>

#include "base/format.hpp"
#include "base/text.hpp"

namespace servoctl::drive {
namespace {

struct StateRow {
  DriveState state;
  std::uint16_t mask;
  std::uint16_t value;
  std::string_view name;
  std::string_view name_zh;
};

/// Masks of CiA 402-2, table 30. Chinese names as servo manuals print them.
constexpr std::array kStates{
    StateRow{DriveState::not_ready_to_switch_on, 0x4F, 0x00, "not ready to switch on", "初始化"},
    StateRow{DriveState::switch_on_disabled, 0x4F, 0x40, "switch on disabled", "伺服无故障"},
    StateRow{DriveState::ready_to_switch_on, 0x6F, 0x21, "ready to switch on", "伺服准备好"},
    StateRow{DriveState::switched_on, 0x6F, 0x23, "switched on", "等待打开伺服使能"},
    StateRow{DriveState::operation_enabled, 0x6F, 0x27, "operation enabled", "伺服运行"},
    StateRow{DriveState::quick_stop_active, 0x6F, 0x07, "quick stop active", "快速停机"},
    StateRow{DriveState::fault_reaction_active, 0x4F, 0x0F, "fault reaction active", "故障停机"},
    StateRow{DriveState::fault, 0x4F, 0x08, "fault", "故障"},
};

struct Transition {
  DriveState from;
  ControlCommand command;
  DriveState to;
};

constexpr std::array kTransitions{
    Transition{DriveState::switch_on_disabled, ControlCommand::shutdown, DriveState::ready_to_switch_on},
    Transition{DriveState::ready_to_switch_on, ControlCommand::switch_on, DriveState::switched_on},
    Transition{DriveState::ready_to_switch_on, ControlCommand::enable_operation,
               DriveState::operation_enabled},
    Transition{DriveState::ready_to_switch_on, ControlCommand::disable_voltage,
               DriveState::switch_on_disabled},
    Transition{DriveState::ready_to_switch_on, ControlCommand::quick_stop, DriveState::switch_on_disabled},
    Transition{DriveState::switched_on, ControlCommand::enable_operation, DriveState::operation_enabled},
    Transition{DriveState::switched_on, ControlCommand::shutdown, DriveState::ready_to_switch_on},
    Transition{DriveState::switched_on, ControlCommand::disable_voltage, DriveState::switch_on_disabled},
    Transition{DriveState::switched_on, ControlCommand::quick_stop, DriveState::switch_on_disabled},
    Transition{DriveState::operation_enabled, ControlCommand::switch_on, DriveState::switched_on},
    Transition{DriveState::operation_enabled, ControlCommand::shutdown, DriveState::ready_to_switch_on},
    Transition{DriveState::operation_enabled, ControlCommand::disable_voltage,
               DriveState::switch_on_disabled},
    Transition{DriveState::operation_enabled, ControlCommand::quick_stop, DriveState::quick_stop_active},
    Transition{DriveState::quick_stop_active, ControlCommand::disable_voltage,
               DriveState::switch_on_disabled},
    Transition{DriveState::quick_stop_active, ControlCommand::enable_operation,
               DriveState::operation_enabled},
    Transition{DriveState::fault, ControlCommand::fault_reset, DriveState::switch_on_disabled},
};

/// Bits whose meaning does not depend on the mode and that do not make up the state (CiA 402-2, 8.4.2).
struct BitRow {
  std::uint8_t bit;
  std::string_view name;
};
constexpr std::array kBits{BitRow{4, "voltage enabled"}, BitRow{7, "warning"}, BitRow{9, "remote"},
                           BitRow{11, "internal limit active"}};

/// Bits 10, 12 and 13 (CiA 402-2, the statusword of each mode). Where the mode has no meaning for one, its
/// number: what is set there is the manufacturer's, or a status toggle.
std::string_view mode_bit(unsigned bit, std::int8_t mode) {
  const bool cyclic = mode >= 8 && mode <= 10;
  if (bit == 10) return cyclic ? "bit 10" : "target reached";
  if (cyclic && bit == 12) return "drive follows command value";
  switch (mode) {
    case 1: return bit == 12 ? "set-point acknowledge" : "following error";
    case 3: return bit == 12 ? "speed is zero" : "maximum slippage";
    case 6: return bit == 12 ? "homing attained" : "homing error";
    case 7: return bit == 12 ? "ip mode active" : "bit 13";
    case 8: return "following error";
    default: return bit == 12 ? "bit 12" : "bit 13";
  }
}

}  // namespace

std::string_view name(DriveState state) {
  for (const auto& row : kStates)
    if (row.state == state) return row.name;
  return "unknown";
}

std::string_view name_zh(DriveState state) {
  for (const auto& row : kStates)
    if (row.state == state) return row.name_zh;
  return "未知";
}

DriveState decode_state(std::uint16_t statusword) {
  for (const auto& row : kStates)
    if ((statusword & row.mask) == row.value) return row.state;
  return DriveState::unknown;
}

bool is_energised(DriveState state) {
  return state == DriveState::operation_enabled || state == DriveState::quick_stop_active ||
         state == DriveState::fault_reaction_active || state == DriveState::unknown;
}

ControlCommand decode_command(std::uint16_t controlword, std::uint16_t before) {
  if ((controlword & 0x80U) != 0)
    return (before & 0x80U) == 0 ? ControlCommand::fault_reset : ControlCommand::none;
  if ((controlword & 0x02U) == 0) return ControlCommand::disable_voltage;
  if ((controlword & 0x04U) == 0) return ControlCommand::quick_stop;
  if ((controlword & 0x01U) == 0) return ControlCommand::shutdown;
  return (controlword & 0x08U) == 0 ? ControlCommand::switch_on : ControlCommand::enable_operation;
}

DriveState next_state(DriveState state, ControlCommand command) {
  for (const auto& row : kTransitions)
    if (row.from == state && row.command == command) return row.to;
  return state;
}

std::vector<std::string> statusword_bits(std::uint16_t statusword, std::int8_t mode) {
  std::vector<std::string> out;
  for (unsigned bit = 0; bit < 16; ++bit) {
    if ((statusword & 1U << bit) == 0) continue;
    const auto* common =
        std::find_if(kBits.begin(), kBits.end(), [&](const BitRow& row) { return row.bit == bit; });
    if (common != kBits.end()) out.emplace_back(common->name);
    if (bit == 10 || bit == 12 || bit == 13) out.emplace_back(mode_bit(bit, mode));
  }
  return out;
}

std::string device_kind(std::uint32_t device_type) {
  const auto profile = device_type & 0xFFFFU;
  if (profile == 0) return "no device profile";
  if (profile != 402)
    return formatted("{} {}", profile >= 400 && profile < 500 ? "CiA" : "device profile", profile);
  if (device_type >> 16 == 0xFFFFU) return "CiA 402, several devices";
  constexpr std::string_view kKinds[] = {"frequency converter", "servo drive", "stepper motor"};
  std::string out;
  for (std::size_t i = 0; i < std::size(kKinds); ++i)
    if ((device_type >> (16 + i) & 1U) != 0) append(out, formatted("{}", kKinds[i]), " and ");
  return "CiA 402, " + (out.empty() ? std::string("kind of drive not stated") : out);
}

std::string_view mode_abbreviation(std::int8_t mode) {
  constexpr std::string_view kNames[] = {"", "pp", "vl", "pv", "pt", "", "hm", "ip", "csp", "csv", "cst"};
  return mode > 0 && static_cast<std::size_t>(mode) < std::size(kNames) ? kNames[mode] : std::string_view();
}

}  // namespace servoctl::drive
