#pragma once

#include <cstdint>
#include <string>

#include "base/object_address.hpp"

namespace servoctl::canopen {

/// Whether no object may be given this CAN-ID of 11 bits: NMT, SDO, error control and the reserved ones (CiA
/// 301, table 40). Those of SYNC, TIME, EMCY and the PDOs may be.
bool is_restricted(std::uint32_t can_id);

/// The identifier in a COB-ID, which is a frame of 11 bits.
inline constexpr std::uint32_t kCanId = 0x7FF;

/// Why this entry cannot hold this COB-ID: `CAN-ID 0x601 is that of SDO`; empty when it can, when bit 31 (or
/// what stands for it) says that it is not in use, and for entries that hold none. Knows the COB-IDs of SYNC
/// (1005h), TIME (1012h), EMCY (1014h), SDO (12xxh:1 and :2) and PDOs (14xxh, 15xxh, 18xxh, 19xxh:1). A
/// CAN-ID of 11 bits must be neither restricted (CiA 301, table 40) nor that of another service of the
/// pre-defined connection set (7.3.5): a drive that sends there speaks with the voice of another, one that
/// listens there takes every such frame for its own. `node` is the drive's own node-ID; 0: any.
std::string cob_id_conflict(ObjectAddress object, std::uint32_t cob_id, std::uint8_t node);

}  // namespace servoctl::canopen
