#pragma once

#include <vector>

#include "session/write_plan.hpp"

namespace servoctl::session {

/// Puts writes to communication objects (1000h to 1FFFh, no PDOs) into an order that a server of CiA 301
/// takes: no node is watched by two entries of 1016h at any moment, also when they exchange theirs; the SYNC
/// counter (1019h) changes while the communication cycle period (1006h) is 0, which is put back; a COB-ID of
/// SYNC, TIME or EMCY in use is switched off before it gets another CAN-ID. Other writes keep their places.
std::vector<PlannedWrite> in_allowed_order(std::vector<PlannedWrite> writes, const Values& present);

}  // namespace servoctl::session
