#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cabinet/cabinet.hpp"
#include "settings/backup_file.hpp"

namespace servoctl::cabinet {

/// One side of a comparison of cabinets: a cabinet file, or backups of its axes.
struct CabinetSide {
  std::string title;
  std::optional<Cabinet> file;
  std::map<std::string, settings::Backup> backups;  ///< By axis, where it is no file.

  std::vector<std::string> axes() const;
};

/// A cabinet file or a folder of `cabinet backup`. Errc::file for what is neither, or not to be read.
Result<CabinetSide> open_cabinet_side(const std::filesystem::path& path);

/// What the file says of an axis beside its parameters, each with a name: `node`, `family`, `heartbeat`,
/// `RPDO1 map`. What it does not say is not there.
std::map<std::string, std::string> said_of(const Axis& axis);

}  // namespace servoctl::cabinet
