#pragma once

#include <cstdint>

#include "canopen/pdo.hpp"
#include "drive/profile.hpp"
#include "session/restore.hpp"
#include "session/session.hpp"
#include "session/write_plan.hpp"

namespace servoctl::session {

/// The values that make `pdo`, in the sizes of those present; what the drive does not have is left out.
Values values_of(const canopen::Pdo& pdo, const Values& present);

/// Adds the stored parameters that the drive copies into these objects at its start, so that they are the
/// same after power-off.
void add_stored_copies(const drive::Profile& profile, std::uint8_t node, Values& wanted);

/// Reads into `present` what `wanted` names beside it. An entry that cannot be read because it is not in use
/// is taken as 0.
Result<void> complete(Session& session, std::uint8_t node, Values& present, const Values& wanted);

/// Errc::refused while the drive is energised: what a PDO means is not changed under a drive that can move. A
/// node without a statusword is none that can.
Result<void> check_not_energised(Session& session, std::uint8_t node);

/// Whether the family allows these writes outside Operational only. `profile` may be null.
bool needs_pre_operational(const drive::Profile* profile, const std::vector<PlannedWrite>& plan);

/// Changes PDOs as a whole: `wanted` in place and read back, or `present` again. Both are PDO parameters of
/// one node, `present` with all entries in use. Where the family demands it the node is pre-operational in
/// between, and its state put back, unless a PDO is neither as wanted nor as it was. A drive of which nothing
/// more is known than the standards, and that refuses, is tried once more pre-operational, unless it is
/// energised or the refusal is no matter of the state, and once more with its COB-ID left alone; the notices
/// say so.
RestoreOutcome change_pdos(Session& session, const drive::Profile* profile, std::uint8_t node,
                           const Values& present, const Values& wanted, const RestoreOptions& options);

}  // namespace servoctl::session
