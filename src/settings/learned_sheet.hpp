#pragma once

#include "od/eds.hpp"
#include "session/identity.hpp"
#include "session/object_scan.hpp"

namespace servoctl::settings {

/// The data sheet of what a scan found on the drive with this identity. Names, types and access of standard
/// objects are those of `standard` (may be null), of another size with the sign and access of the standard;
/// those of CiA 402 only of an axis that has a statusword, or if 1000h names that profile. Else the type is
/// the unsigned one of the size, or text; what can be read is `ro`, because reading does not show whether it
/// can be written. If the drive answers every short object with four bytes, or an object can only be
/// written, its name says `(size unknown)`. Defaults are only what is the same in each drive of the type.
/// What a PDO carries now can be mapped.
od::EdsFile learned_sheet(const session::ScanState& state, const session::Identity& identity,
                          const od::Dictionary* standard);

}  // namespace servoctl::settings
