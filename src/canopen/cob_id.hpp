#pragma once

#include <cstdint>

#include "canopen/node_id.hpp"

namespace servoctl::canopen {

/// Bases of the pre-defined connection set (CiA 301, 7.3.5); the node-ID is added, except to kNmt and kSync.
inline constexpr std::uint32_t kNmt = 0x000;
inline constexpr std::uint32_t kSync = 0x080;
inline constexpr std::uint32_t kEmergency = 0x080;
inline constexpr std::uint32_t kSdoAnswer = 0x580;     ///< From the server, the drive.
inline constexpr std::uint32_t kSdoRequest = 0x600;    ///< From the client.
inline constexpr std::uint32_t kErrorControl = 0x700;  ///< Boot-up, heartbeat and node guarding.

}  // namespace servoctl::canopen
