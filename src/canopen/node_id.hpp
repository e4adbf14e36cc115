#pragma once

#include <cstdint>

namespace servoctl::canopen {

/// Node-IDs of CiA 301: 1..127; 0 means all nodes in an NMT command.
inline constexpr std::uint8_t kFirstNode = 1;
inline constexpr std::uint8_t kLastNode = 127;

}  // namespace servoctl::canopen
