#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "drive/profile.hpp"
#include "session/session.hpp"
#include "session/storage.hpp"
#include "session/write_plan.hpp"

namespace servoctl::session {

struct RestoreOptions {
  bool roll_back = true;
  bool keep = false;
  bool unlock = false;
};

/// What came of a restore. The ways it can end:
/// - `failure` is empty: every value is as wanted, read back, and kept as `kept` says;
/// - `failure` and `all_written`: every value is as wanted, but keeping it, or locking the drive again,
///   failed;
/// - `failure` and `rolled_back`: every value is as it was before, but for `in_flash`;
/// - `failure` and `astray`: these objects could not be shown to be as they were before;
/// - `failure` alone: `roll_back` was false, what was written stays written.
struct RestoreOutcome {
  std::size_t writes = 0;  ///< That were acknowledged and read back, of the way there.
  std::optional<Error> failure;
  bool all_written = false;
  bool rolled_back = false;
  std::vector<ObjectAddress> astray;
  /// Of a drive that worked in its RAM and was told to keep: what was, or may have been, written to its
  /// flash. What stood there before nobody knows, and what stood in the RAM was a trial: it is put back in
  /// the RAM alone.
  std::vector<ObjectAddress> in_flash;
  Kept kept = Kept::unknown;
  std::vector<Message> notices;
};

/// Carries the plan out: writes and reads back one value after the other, stores once at the end and only if
/// all is well. On a failure the values from before are put back, unless `roll_back` is false, to the memory
/// that the drive worked with; whatever the way out, all objects are read once more at its end. Never writes
/// a value twice in the same direction.
RestoreOutcome restore(Session& session, const drive::Profile* profile, std::uint8_t node,
                       const Values& present, const Values& wanted, const RestoreOptions& options);

/// What restore() would send while nothing goes wrong, with what is written for the memory, the password and
/// the storing. Errors as StorageScope::open() and close().
Result<void> rehearse_restore(Session& session, const drive::Profile* profile, std::uint8_t node,
                              const Values& present, const Values& wanted, const RestoreOptions& options,
                              Rehearsal& rehearsal);

}  // namespace servoctl::session
