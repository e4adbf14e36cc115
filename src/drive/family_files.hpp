#pragma once

#include <filesystem>
#include <span>

#include "base/result.hpp"

namespace servoctl::drive {

struct Family;

/// The user's own families: `$XDG_CONFIG_HOME/servoctl/drives`, `~/.config/servoctl/drives`. Errc::usage if
/// neither variable is set.
Result<std::filesystem::path> own_families_folder();

/// Errc::file, naming the key, where the parents of a family lead back to it or to one of them.
Result<void> check_parents(const Family& family, std::span<const std::filesystem::path> folders);

/// Whether a file of a family may be used. One in a folder that was only found (the user's own, or beside the
/// program) and is not named in $SERVOCTL_DRIVES must not be another user's, or open to others: see
/// check_found_file(); the owner of the program counts as trusted. Errc::refused with the way to name it.
Result<void> check_family_file(const std::filesystem::path& file);

}  // namespace servoctl::drive
