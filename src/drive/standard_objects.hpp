#pragma once

#include <cstdint>

#include "base/object_address.hpp"

/// Objects of CiA 301 (1000h to 1FFFh) and CiA 402-2 (6000h to 9FFFh) that programs and simulated drives
/// name, called as the standards call them.
namespace servoctl::objects {

inline constexpr ObjectAddress kDeviceType{0x1000, 0};
inline constexpr ObjectAddress kDeviceName{0x1008, 0};
inline constexpr ObjectAddress kVendorId{0x1018, 1};
inline constexpr ObjectAddress kProductCode{0x1018, 2};
inline constexpr ObjectAddress kRevision{0x1018, 3};
inline constexpr ObjectAddress kSerialNumber{0x1018, 4};
inline constexpr ObjectAddress kErrorRegister{0x1001, 0};
inline constexpr ObjectAddress kErrorHistory{0x1003, 0};  ///< Pre-defined error field, its count.
inline constexpr ObjectAddress kSyncCobId{0x1005, 0};
inline constexpr ObjectAddress kSyncPeriod{0x1006, 0};  ///< Communication cycle period, µs.
inline constexpr ObjectAddress kTimeCobId{0x1012, 0};
inline constexpr ObjectAddress kEmergencyCobId{0x1014, 0};
inline constexpr ObjectAddress kEmergencyInhibit{0x1015, 0};             ///< In 100 µs.
inline constexpr ObjectAddress kCommunicationErrorBehaviour{0x1029, 1};  ///< NMT state after it.
inline constexpr ObjectAddress kSyncOverflow{0x1019, 0};  ///< Synchronous counter overflow value.
inline constexpr ObjectAddress kGuardTime{0x100C, 0};     ///< ms.
inline constexpr ObjectAddress kLifeTimeFactor{0x100D, 0};
inline constexpr std::uint16_t kStoreIndex = 0x1010;
inline constexpr std::uint16_t kRestoreIndex = 0x1011;
inline constexpr ObjectAddress kStoreAll{kStoreIndex, 1};
inline constexpr ObjectAddress kRestoreAll{kRestoreIndex, 1};
inline constexpr std::uint32_t kSaveSignature =
    0x6576'6173;  ///< "save", written to 1010h (CiA 301, 7.5.2.13).
inline constexpr std::uint32_t kLoadSignature =
    0x6461'6F6C;  ///< "load", written to 1011h (CiA 301, 7.5.2.14).
inline constexpr std::uint16_t kConsumerHeartbeatIndex = 0x1016;
inline constexpr ObjectAddress kProducerHeartbeat{0x1017, 0};  ///< ms; 0: none.

inline constexpr ObjectAddress kAbortConnectionOption{0x6007, 0};
inline constexpr ObjectAddress kErrorCode{0x603F, 0};
inline constexpr ObjectAddress kControlword{0x6040, 0};
inline constexpr ObjectAddress kStatusword{0x6041, 0};
inline constexpr ObjectAddress kQuickStopOption{0x605A, 0};
inline constexpr ObjectAddress kModeOfOperation{0x6060, 0};
inline constexpr ObjectAddress kModeDisplay{0x6061, 0};
inline constexpr ObjectAddress kSupportedModes{0x6502, 0};

inline constexpr ObjectAddress kInternalPosition{0x6063, 0};  ///< Encoder increments.
inline constexpr ObjectAddress kPositionActual{0x6064, 0};
inline constexpr ObjectAddress kFollowingErrorWindow{0x6065, 0};
inline constexpr ObjectAddress kFollowingErrorTime{0x6066, 0};  ///< ms.
inline constexpr ObjectAddress kPositionWindow{0x6067, 0};
inline constexpr ObjectAddress kVelocitySensor{0x6069, 0};
inline constexpr ObjectAddress kVelocityDemand{0x606B, 0};
inline constexpr ObjectAddress kVelocityActual{0x606C, 0};
inline constexpr ObjectAddress kTorqueActual{0x6077, 0};
inline constexpr ObjectAddress kSupplyVoltage{0x6079, 0};  ///< DC link, mV.
inline constexpr ObjectAddress kFollowingError{0x60F4, 0};
inline constexpr ObjectAddress kDigitalInputs{0x60FD, 0};
inline constexpr std::uint16_t kDigitalOutputsIndex = 0x60FE;

inline constexpr ObjectAddress kTargetTorque{0x6071, 0};
inline constexpr ObjectAddress kTargetPosition{0x607A, 0};
inline constexpr ObjectAddress kTargetVelocity{0x60FF, 0};
inline constexpr ObjectAddress kLowerPositionLimit{0x607D, 1};
inline constexpr ObjectAddress kUpperPositionLimit{0x607D, 2};
inline constexpr ObjectAddress kMaxProfileVelocity{0x607F, 0};
inline constexpr ObjectAddress kMaxMotorSpeed{0x6080, 0};
inline constexpr ObjectAddress kProfileVelocity{0x6081, 0};
inline constexpr ObjectAddress kProfileAcceleration{0x6083, 0};
inline constexpr ObjectAddress kProfileDeceleration{0x6084, 0};
inline constexpr ObjectAddress kMaxTorque{0x6072, 0};
inline constexpr ObjectAddress kTorqueSlope{0x6087, 0};

inline constexpr ObjectAddress kInterpolationPoint{0x60C1, 1};
inline constexpr ObjectAddress kInterpolationPeriod{0x60C2, 1};
inline constexpr ObjectAddress kInterpolationIndex{0x60C2, 2};  ///< Power of ten of its unit, the second.
inline constexpr ObjectAddress kMaxSlippage{0x60F8, 0};

inline constexpr ObjectAddress kHomeOffset{0x607C, 0};
inline constexpr ObjectAddress kHomingMethod{0x6098, 0};
inline constexpr std::uint16_t kSupportedHomingIndex = 0x60E3;
inline constexpr ObjectAddress kHomingSpeedSwitch{0x6099, 1};
inline constexpr ObjectAddress kHomingSpeedZero{0x6099, 2};
inline constexpr ObjectAddress kHomingAcceleration{0x609A, 0};

}  // namespace servoctl::objects
