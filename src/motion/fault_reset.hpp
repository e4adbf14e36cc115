#pragma once

#include <cstdint>
#include <vector>

#include "drive/profile.hpp"
#include "session/rehearsal.hpp"
#include "session/session.hpp"

namespace servoctl::motion {

/// What came of a fault reset.
enum class FaultReset : std::uint8_t { no_fault, done };

/// Resets the fault of a drive and waits until the statusword says so. Only a drive in "fault" is written to:
/// the controlwords 0000h, 0080h, 0000h (edge and release; none of them can enable it), then the settings of
/// the family's rules if the fault is still there. The release is written on every way out, Ctrl-C waits for
/// it. `profile` may be null. Errc::negative when the fault stays, or when the drive is energised after it;
/// Errc::refused while the drive is energised before.
Result<FaultReset> reset_fault(session::Session& session, const drive::Profile* profile, std::uint8_t node);

/// What reset_fault() would write, by the state the drive is in now; empty where there is no fault.
/// Errc::refused as there.
Result<std::vector<session::PlannedMessage>> plan_fault_reset(session::Session& session,
                                                              const drive::Profile* profile,
                                                              std::uint8_t node);

}  // namespace servoctl::motion
