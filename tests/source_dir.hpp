#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace servoctl {

/// The folder of the sources: tests read the drive data and their own files where they stand.
std::string source_dir();

/// Where the data of drives are looked for.
inline const std::vector<std::filesystem::path> kFolders{std::filesystem::path(source_dir()) / "eds"};

}  // namespace servoctl
