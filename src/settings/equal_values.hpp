#pragma once

#include <vector>

#include "settings/change.hpp"

namespace servoctl::settings {

/// Reads what the drives hold now into Change::before, and marks as Change::unchanged what a write would not
/// change: a panel parameter of a known family that is a plain value, as long in the drive as in the change,
/// and equal. What starts an action, moves or energises a motor, is guarded by a password, has no
/// described purpose, or is to go to a flash behind the RAM that was read, is never marked. A value that
/// cannot be read is written.
void mark_unchanged(show::Desk& desk, std::vector<Change>& changes, const WriteOptions& options);

/// After the other writes: what they have altered of the values that were left out is written after all.
void write_altered(show::Desk& desk, std::vector<Change>& changes,
                   std::vector<Result<session::Written>>& written);

}  // namespace servoctl::settings
