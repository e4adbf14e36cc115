#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "drive/profile.hpp"
#include "session/session.hpp"
#include "session/storage.hpp"

namespace servoctl::session {

/// Values of one drive by object.
using Values = std::map<ObjectAddress, Bytes>;

/// One write of a plan.
struct PlannedWrite {
  ObjectAddress object;
  Bytes data;
};

/// The writes that lead from `present` to `wanted`, both over the same objects: only what differs, in rising
/// address, each PDO by the procedure of CiA 301, 7.5.2.35 (invalid, count 0, entries, count, parameters,
/// COB-ID) or the family's own. `profile` may be null.
std::vector<PlannedWrite> plan_writes(const drive::Profile* profile, const Values& present,
                                      const Values& wanted);

struct RestoreOptions {
  bool roll_back = true;
  bool keep = false;
  bool unlock = false;
};

/// What came of a restore. The three ways it can end: `failure` is empty and every value is as wanted;
/// `failure` says what went wrong and `astray` is empty: every value is as it was before; `astray` names the
/// objects of which neither can be said.
struct RestoreOutcome {
  std::size_t writes = 0;  ///< That were acknowledged and read back, of the way there.
  std::optional<Error> failure;
  bool rolled_back = false;
  std::vector<ObjectAddress> astray;
  Kept kept = Kept::unknown;
  std::vector<std::string> notices;
};

/// Carries the plan out: writes and reads back one value after the other, stores once at the end and only if
/// all is well. On a failure the values from before are put back, unless `roll_back` is false; whatever the
/// way out, all objects are read once more at its end. Never writes a value twice in the same direction.
RestoreOutcome restore(Session& session, const drive::Profile* profile, std::uint8_t node,
                       const Values& present, const Values& wanted, const RestoreOptions& options);

}  // namespace servoctl::session
