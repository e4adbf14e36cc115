#pragma once

#include <filesystem>

#include "cabinet/cabinet_check.hpp"
#include "show/desk.hpp"

namespace servoctl::cabinet {

/// Compares two cabinet files, two folders of back_up_cabinet(), or one of each, axis by axis: backups value
/// by value, files by what they say of each axis, a backup with a file by what the file says of the drive
/// that was saved. The answer is `{compared, different, differences[{axis object name a b}]}`; a difference
/// is Errc::negative in `desk.errors`. What no data says without a drive is named in `desk.notices`.
/// Errc::file for what is neither.
Result<report::Value> compare_cabinets(show::Desk& desk, const std::filesystem::path& a,
                                       const std::filesystem::path& b, const LoadProfile& load);

}  // namespace servoctl::cabinet
