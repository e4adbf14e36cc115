#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/object_address.hpp"

namespace servoctl::drive {

/// Whether a device type (1000h) is that of a drive of CiA 402: 0192h in its low word.
constexpr bool is_drive_type(std::uint64_t device_type) { return (device_type & 0xFFFFU) == 0x0192; }

/// Axes of one node.
inline constexpr unsigned kMostAxes = 8;
/// The object of axis 1 to kMostAxes: those of each further axis are 800h higher (CiA 402-2).
constexpr ObjectAddress of_axis(ObjectAddress object, unsigned number) {
  return {static_cast<std::uint16_t>(object.index + (number - 1) * 0x800U), object.sub};
}

/// States of the power drive system (CiA 402-2, 8.2.3).
enum class DriveState : std::uint8_t {
  not_ready_to_switch_on,
  switch_on_disabled,
  ready_to_switch_on,
  switched_on,
  operation_enabled,
  quick_stop_active,
  fault_reaction_active,
  fault,
  unknown,  ///< Bits that fit no state.
};

std::string_view name(DriveState state);     ///< `switch on disabled`
std::string_view name_zh(DriveState state);  ///< `伺服无故障`

/// The state in a statusword (6041h): bits 0 to 3, 5 and 6; all others are masked.
DriveState decode_state(std::uint16_t statusword);

/// Whether the power stage may be energised in this state.
bool is_energised(DriveState state);

/// The commands a controlword (6040h) can carry (CiA 402-2, table 28), by bits 0 to 3 and 7.
enum class ControlCommand : std::uint8_t {
  none,
  shutdown,
  switch_on,
  enable_operation,
  disable_voltage,
  quick_stop,
  fault_reset
};

/// The command in a controlword. A fault reset is the rising edge of bit 7, seen against the controlword
/// before; while bit 7 stays set no other command is carried out.
ControlCommand decode_command(std::uint16_t controlword, std::uint16_t before);

/// The state the command leads to, or the same state where it does nothing there. Transitions 2 to 12, 15 and
/// 16; those the drive makes by itself are not in it. Switch on + enable operation in one step (3 and 4) is
/// followed.
DriveState next_state(DriveState state, ControlCommand command);

/// The bits of a statusword with their common meaning, low to high: `quick_stop`, `warning`, `remote`, … Bits
/// 12 and 13 depend on the mode of operation (0 when unknown).
std::vector<std::string> statusword_bits(std::uint16_t statusword, std::int8_t mode);

/// A mode of operation as CiA 402-2 abbreviates it (object 6502h): `pp`, `csv`; empty for one that the
/// standard does not have.
std::string_view mode_abbreviation(std::int8_t mode);

/// What 1000h announces in words, `CiA 402, servo drive`: the profile in bits 0 to 15, and of CiA 402 the
/// kinds of drive in bits 16 to 18, or FFFFh above the profile for a module of several devices (CiA
/// 301, 7.5.2.1; CiA 402-2, object 1000h). No proof of what the drive is. In English and of one line.
std::string device_kind(std::uint32_t device_type);

}  // namespace servoctl::drive
