#pragma once

#include <cstdint>

#include "base/object_address.hpp"

/// Objects of CiA 301 and CiA 402-2 to which the simulated drive gives a behaviour.
namespace servoctl::sim {

inline constexpr ObjectAddress kErrorRegister{0x1001, 0};
inline constexpr ObjectAddress kErrorHistory{0x1003, 0};
inline constexpr ObjectAddress kGuardTime{0x100C, 0};
inline constexpr ObjectAddress kLifeFactor{0x100D, 0};
inline constexpr ObjectAddress kStore{0x1010, 1};
inline constexpr ObjectAddress kRestore{0x1011, 1};
inline constexpr std::uint16_t kConsumerIndex = 0x1016;
inline constexpr ObjectAddress kHeartbeatTime{0x1017, 0};
inline constexpr ObjectAddress kAbortConnectionOption{0x6007, 0};
inline constexpr ObjectAddress kErrorCode{0x603F, 0};
inline constexpr ObjectAddress kControlword{0x6040, 0};
inline constexpr ObjectAddress kStatusword{0x6041, 0};
inline constexpr ObjectAddress kQuickStopOption{0x605A, 0};
inline constexpr ObjectAddress kModes{0x6060, 0};
inline constexpr ObjectAddress kModeDisplay{0x6061, 0};

inline constexpr ObjectAddress kFollowingErrorWindow{0x6065, 0};
inline constexpr ObjectAddress kFollowingError{0x60F4, 0};

inline constexpr std::uint32_t kSaveSignature = 0x6576'6173;  ///< "save" (CiA 301, 7.5.2.13).
inline constexpr std::uint32_t kLoadSignature = 0x6461'6F6C;  ///< "load" (CiA 301, 7.5.2.14).

}  // namespace servoctl::sim
