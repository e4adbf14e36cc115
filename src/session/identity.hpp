#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "base/object_address.hpp"
#include "session/node_state.hpp"

namespace servoctl::session {

/// What a node says of itself; each field is empty when the drive has no such object.
struct Identity {
  std::uint8_t node = 0;
  std::optional<std::uint32_t> device_type;   ///< 1000h
  std::optional<std::uint32_t> vendor_id;     ///< 1018h:01
  std::optional<std::uint32_t> product_code;  ///< 1018h:02
  std::optional<std::uint32_t> revision;      ///< 1018h:03
  std::optional<std::uint32_t> serial;        ///< 1018h:04
  std::string device_name;                    ///< 1008h
  std::string hardware_version;               ///< 1009h
  std::string software_version;               ///< 100Ah
  bool by_registers = false;                  ///< Of Modbus, where nothing tells what a device is.
  std::optional<NodeState> state;             ///< Heard from heartbeat or boot-up, if any.
  std::map<ObjectAddress, bool>
      looked;  ///< Objects of families that were looked for: whether they are there.
};

/// In which number two differ, in words (`its serial number (1018h:04)`); empty: in none.
std::string different_number(const Identity& before, const Identity& now);

}  // namespace servoctl::session
