#pragma once

#include "cabinet/cabinet.hpp"
#include "settings/backup_file.hpp"
#include "show/desk.hpp"

namespace servoctl::cabinet {

/// What an axis is to hold, as a backup whose entries have the lines of the cabinet file: its parameters, its
/// PDOs and its heartbeat, the first where two say the same of one object. Units are converted by what the
/// drive's own objects tell, PDOs follow those that it has: both are read, nothing is written. With `keep`
/// what the family's drives copy into PDO objects at their start is part of it.
///
/// `desk` has the session, and the family of the axis. Errc::usage, Errc::file or Errc::refused with file and
/// line for a name that the family does not have, a value that does not fit, a PDO that the drive does not
/// have, an object that is said twice with two values, node-ID and bitrate; else as Session::upload().
Result<settings::Backup> wanted_backup(show::Desk& desk, const Cabinet& cabinet, const Axis& axis, bool keep);

/// The same without a drive, as far as that can be judged: names, values without the drive's units, presets
/// and files of PDOs.
Result<void> check_wanted(const show::Desk& desk, const Cabinet& cabinet, const Axis& axis);

}  // namespace servoctl::cabinet
