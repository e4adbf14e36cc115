#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/object_address.hpp"

namespace servoctl::drive {

/// How the objects are reached over Modbus: an object with sub-index 0 and two bytes is one holding register.
struct ModbusRules {
  /// Objects `index`, `index + 1`, … stand in the registers `at`, `at + 1`, …
  struct Block {
    std::uint16_t index = 0;
    std::uint16_t count = 0;
    std::uint16_t at = 0;
  };
  std::vector<Block> registers;
  std::string node_id;               ///< Parameter of the unit address.
  std::string baud;                  ///< Parameter of the speed.
  std::string framing;               ///< Parameter that chooses RTU or ASCII.
  std::uint32_t silence_ms = 0;      ///< The silence that ends a message; 0: that of the standard.
  std::vector<std::string> at_rest;  ///< Parameters that are 0 while the drive is at rest and not enabled.
  std::vector<std::string> targets;  ///< Parameters that an enabled drive follows at once: none is restored.
  std::vector<std::string> shows;    ///< Parameters that `info` shows: registers tell no identity.
  std::uint16_t inputs = 0;          ///< Digital inputs, by function 02h from address 0.
  std::uint16_t outputs = 0;         ///< Digital outputs, by function 01h from address 0.
  std::string motion;                ///< What motion there is over Modbus, in the drive's internal modes.
  std::string motion_zh;

  bool exists() const { return !registers.empty(); }
  /// The register of an object; empty where it has none.
  std::optional<std::uint16_t> register_of(ObjectAddress object) const;
  /// The object in a register; empty where none is.
  std::optional<ObjectAddress> object_at(std::uint16_t address) const;
};

}  // namespace servoctl::drive
