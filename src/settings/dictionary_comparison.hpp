#pragma once

#include "settings/backup_file.hpp"

namespace servoctl::settings {

/// Whether both are EDS or DCF files and one of them, an EDS, has no value to compare.
bool are_data_sheets(const BackupSource& a, const BackupSource& b);

/// `{compared, different, differences[{index sub name field a b}]}`: every entry of either; what one side
/// lacks has the field `entry`, and null there. Differences make an error in the desk. Errc::file.
Result<report::Value> compare_data_sheets(show::Desk& desk, const BackupSource& a, const BackupSource& b);

}  // namespace servoctl::settings
