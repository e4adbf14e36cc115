#pragma once

#include <cstdint>
#include <string>

#include "settings/backup_file.hpp"
#include "show/desk.hpp"

namespace servoctl::settings {

/// A notice for the node-ID and for the bitrate each where the backup has another value than the drive, which
/// keeps its own. The node-ID of another drive is expected to differ, and not told. Only reads; what the
/// drive does not tell is not compared. `title` names the backup. True where there is one.
bool tell_kept_address(show::Desk& desk, const Backup& backup, const Message& title, std::uint8_t node);

}  // namespace servoctl::settings
