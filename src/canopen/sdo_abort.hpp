#pragma once

#include <cstdint>
#include <string>

#include "base/object_address.hpp"

namespace servoctl::canopen {

/// SDO abort codes of CiA 301, 7.2.4.3.17, as far as the machines here raise them themselves.
namespace sdo_abort {
inline constexpr std::uint32_t kToggle = 0x0503'0000;
inline constexpr std::uint32_t kTimeout = 0x0504'0000;
inline constexpr std::uint32_t kCommand = 0x0504'0001;
inline constexpr std::uint32_t kBlockSize = 0x0504'0002;
inline constexpr std::uint32_t kSequence = 0x0504'0003;
inline constexpr std::uint32_t kCrc = 0x0504'0004;
inline constexpr std::uint32_t kOutOfMemory = 0x0504'0005;
inline constexpr std::uint32_t kUnsupportedAccess = 0x0601'0000;
inline constexpr std::uint32_t kWriteOnly = 0x0601'0001;
inline constexpr std::uint32_t kReadOnly = 0x0601'0002;
inline constexpr std::uint32_t kNoObject = 0x0602'0000;
inline constexpr std::uint32_t kNotMappable = 0x0604'0041;
inline constexpr std::uint32_t kPdoLength = 0x0604'0042;
inline constexpr std::uint32_t kIncompatible = 0x0604'0043;
inline constexpr std::uint32_t kLength = 0x0607'0010;
inline constexpr std::uint32_t kTooLong = 0x0607'0012;
inline constexpr std::uint32_t kTooShort = 0x0607'0013;
inline constexpr std::uint32_t kNoSubIndex = 0x0609'0011;
inline constexpr std::uint32_t kRange = 0x0609'0030;
inline constexpr std::uint32_t kTooHigh = 0x0609'0031;
inline constexpr std::uint32_t kTooLow = 0x0609'0032;
inline constexpr std::uint32_t kGeneral = 0x0800'0000;
inline constexpr std::uint32_t kCannotStore = 0x0800'0020;
inline constexpr std::uint32_t kLocalControl = 0x0800'0021;
inline constexpr std::uint32_t kDeviceState = 0x0800'0022;
inline constexpr std::uint32_t kNoData = 0x0800'0024;
}  // namespace sdo_abort

/// What the code says in plain words, those of CANopen over EtherCAT (ETG.1000.6, table 41) as well. A code
/// that neither lists is named by its class (the error class is the high byte), so that a vendor's own code
/// still says something.
std::string sdo_abort_text(std::uint32_t code);

/// What the user can do about it; empty when the code leaves nothing to say.
std::string sdo_abort_hint(std::uint32_t code);

/// The same of a write, where CiA 301 says more of its object: parameters of PDOs, 1016h and 1019h.
std::string sdo_abort_hint(std::uint32_t code, ObjectAddress object);

/// Whether a server that answers a request for a block transfer with this code may take an ordinary one: it
/// says something about the kind of transfer, nothing about the object.
bool refuses_block_transfer(std::uint32_t code);

/// Whether CiA 301 lists the code.
bool is_standard_sdo_abort(std::uint32_t code);

}  // namespace servoctl::canopen
