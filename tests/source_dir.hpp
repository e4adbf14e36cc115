#pragma once

#include <string>

namespace servoctl {

/// The folder of the sources: tests read the drive data and their own files where they stand.
std::string source_dir();

}  // namespace servoctl
