#pragma once

#include <map>
#include <set>
#include <vector>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "drive/profile.hpp"

namespace servoctl::session {

/// Values of one drive by object.
using Values = std::map<ObjectAddress, Bytes>;

/// One write of a plan.
struct PlannedWrite {
  ObjectAddress object;
  Bytes data;
};

/// The writes that lead from `present` to `wanted`, both over the same objects: only what differs. First the
/// node-ID and the bitrate by the family's parameters, then the parameters (from 2000h on), the communication
/// objects in an order that is taken (in_allowed_order()), the PDOs, and the heartbeat (1016h, 1017h); each
/// in rising address. The PDOs change together by the procedure of CiA 301, 7.5.2.35, or the family's own:
/// all that change invalid, then of each count 0, entries, count and parameters, then all COB-IDs as wanted.
/// So none has the COB-ID that another still has, also when two exchange theirs. An assignment of fixed PDOs
/// (1C10h to 1C2Fh) is written by count 0, entries, count. `profile` may be null.
std::vector<PlannedWrite> plan_writes(const drive::Profile* profile, const Values& present,
                                      const Values& wanted);

/// The writes that lead to `wanted` from whatever a drive holds: as if everything differed and every PDO,
/// every heartbeat consumer and every COB-ID were in use. Entries of a mapping behind its count are left out.
std::vector<PlannedWrite> plan_writes_for_any_drive(const Values& wanted);

/// What these writes may change: the objects written, and with a list (mapping, assignment) all its entries,
/// which a count of 0 may clear. Only what is in `present`.
std::set<ObjectAddress> touched_by(const std::vector<PlannedWrite>& plan, const Values& present);

}  // namespace servoctl::session
