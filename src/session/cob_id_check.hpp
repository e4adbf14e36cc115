#pragma once

#include <cstdint>

#include "base/bytes.hpp"
#include "base/result.hpp"
#include "drive/profile.hpp"

namespace servoctl::session {

/// Whether an object may hold this value, as far as it is a COB-ID, or a panel parameter that the drive takes
/// one from at its start (canopen::cob_id_conflict()). Asked for every source of a value: a command line, a
/// file, another drive. Errc::usage. `profile` may be null; `node` is the drive's own, 0: any.
Result<void> check_cob_id(const drive::Profile* profile, ObjectAddress object, ByteSpan data,
                          std::uint8_t node);

}  // namespace servoctl::session
