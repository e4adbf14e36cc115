#pragma once

#include <cstdint>

namespace servoctl::canopen {

/// Node-IDs of CiA 301: 1..127; 0 means all nodes in an NMT command.
inline constexpr std::uint8_t kFirstNode = 1;
inline constexpr std::uint8_t kLastNode = 127;
/// The node-ID of a device that has none (CiA 305, 3.2).
inline constexpr std::uint8_t kUnconfigured = 0xFF;

}  // namespace servoctl::canopen
