#pragma once

#include <cstdint>

#include "base/result.hpp"
#include "drive/profile.hpp"
#include "session/session.hpp"
#include "session/write_plan.hpp"

namespace servoctl::session {

/// Adds to both the COB-ID of each PDO that changes and whose COB-ID nobody wants to change: a plan of writes
/// makes the PDO invalid first and valid at the end (CiA 301, 7.5.2.37), and what is noted before the first
/// write has the COB-ID. The one in `before` (old values of an interrupted restore) counts, not the one that
/// the drive has now. Both hold the same objects.
Result<void> add_pdo_cob_ids(Session& session, const drive::Profile& profile, std::uint8_t node,
                             const Values& before, Values& present, Values& wanted);

}  // namespace servoctl::session
