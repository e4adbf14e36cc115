#pragma once

#include <string_view>

#include "base/result.hpp"

namespace servoctl::drive {

/// Whether tables stand in each other no deeper than toml++ can bear: it reads and destroys them one call a
/// level, and counts those of brackets (to 256), not those of dotted keys. Errc::file with the line.
Result<void> check_toml_depth(std::string_view toml, std::string_view file);

}  // namespace servoctl::drive
