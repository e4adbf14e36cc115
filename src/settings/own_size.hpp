#pragma once

#include <vector>

#include "session/write.hpp"
#include "settings/change.hpp"

namespace servoctl::settings {

/// What the drive refused because of its length is written again, as the same number in the size that the
/// object has in the drive, and what was left out behind it. Nothing is changed whose type the user said.
void write_in_own_size(show::Desk& desk, std::vector<Change>& changes,
                       std::vector<session::SdoRequest>& requests,
                       std::vector<Result<session::Written>>& written, bool read_back);

}  // namespace servoctl::settings
