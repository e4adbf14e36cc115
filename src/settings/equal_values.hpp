#pragma once

#include <span>
#include <vector>

#include "settings/change.hpp"

namespace servoctl::settings {

/// Reads what the drives hold now into Change::before, and marks as Change::unchanged what a write would not
/// change: a panel parameter of a known family that is a plain value, as long in the drive as in the change,
/// and equal. What starts an action, moves or energises a motor, is guarded by a password, has no
/// described purpose, or is to be kept in a flash whose value a read of the RAM does not show, is never
/// marked. A value that cannot be read is written.
void mark_unchanged(show::Desk& desk, std::vector<Change>& changes, const WriteOptions& options);

/// Writes all but what is unchanged, which counts as written and read back. `requests`: one for each change.
std::vector<Result<session::Written>> write_open(show::Desk& desk, std::span<const Change> changes,
                                                 std::span<const session::SdoRequest> requests,
                                                 bool read_back);

/// After the other writes: what they have altered of the values that were left out is written after all.
void write_altered(show::Desk& desk, std::vector<Change>& changes,
                   std::vector<Result<session::Written>>& written);

}  // namespace servoctl::settings
