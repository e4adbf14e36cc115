#pragma once

#include "cabinet/cabinet.hpp"
#include "session/write_plan.hpp"
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

/// The same for a drive that held these values, without asking it: `desk` has no session. What only a drive
/// can tell (a unit that its gear converts, a size that no manual states) is left out, and named in
/// `desk.notices`.
Result<settings::Backup> wanted_of_held(show::Desk& desk, const Cabinet& cabinet, const Axis& axis,
                                        const session::Values& held);

/// A value in the unit of the axis' load as one in the motor's; any other text as it is.
std::string in_units_of_motor(const Axis& axis, const std::string& text);

}  // namespace servoctl::cabinet
