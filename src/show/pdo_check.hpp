#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/result.hpp"
#include "canopen/pdo.hpp"
#include "drive/profile.hpp"

/// What can be said of a PDO before a frame is sent.
namespace servoctl::show {

/// Bits of a mapped object by the dictionary, or by the number of a gap (0001h to 0007h); empty when not
/// known.
std::optional<std::uint8_t> bits_of(const drive::Profile& profile, ObjectAddress object);

/// Whether an entry goes into a PDO of this direction; where the manual does not state it, the drive will
/// tell.
bool may_map(const od::Entry& entry, canopen::PdoDirection direction);

/// Whether the family's drives map this: objects there, mappable in this direction, of this length, no more
/// than fit. What the dictionary of a drive of unknown family does not list is left to the drive.
/// Errc::usage.
Result<void> check_mapping(const drive::Profile& profile, const canopen::Pdo& pdo);

/// Whether the communication parameters can become these: COB-ID bits that may change, a CAN-ID that is free,
/// a transmission type there is. `all` are the PDOs of the node as they will be. Errc::usage.
Result<void> check_communication(const drive::Profile& profile, const canopen::Pdo& present,
                                 const canopen::Pdo& wanted, std::span<const canopen::Pdo> all);

}  // namespace servoctl::show
