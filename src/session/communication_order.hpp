#pragma once

#include <vector>

#include "session/write_plan.hpp"

namespace servoctl::session {

/// Puts writes to communication objects (1000h to 1FFFh, no PDOs) into an order that a server of CiA 301
/// takes: no node is watched by two entries of 1016h at any moment, also when they exchange theirs; the SYNC
/// counter (1019h) changes while the communication cycle period (1006h) is 0, which is put back; a COB-ID of
/// SYNC, TIME or EMCY in use is switched off before it gets another CAN-ID. Other writes keep their places.
std::vector<PlannedWrite> in_allowed_order(std::vector<PlannedWrite> writes, const Values& present);

/// Whether such an order may write an object twice: cleared or switched off first.
bool is_written_in_steps(ObjectAddress object);

/// The same for a drive of which nothing is known: what may be in the way is cleared or switched off first,
/// whether it is there or not.
std::vector<PlannedWrite> in_order_for_any_drive(std::vector<PlannedWrite> writes);

}  // namespace servoctl::session
