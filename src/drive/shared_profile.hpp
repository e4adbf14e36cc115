#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

#include "base/result.hpp"
#include "drive/profile.hpp"

namespace servoctl::drive {

/// As load_profile(); but the files of a family by its name are read once by the process as long as they
/// (its own, not those of its parents) stay as they are, for whoever asks: the simulated drive and the
/// command that speaks to it, another thread. A user's own file is read anew each time.
Result<std::shared_ptr<const Profile>> shared_profile(std::string_view family,
                                                      std::span<const std::filesystem::path> folders);

/// As load_rules(), read once by the process as long as the file stays as it is. Whoever looks for the family
/// of a drive asks for those of all families, at each line of a prompt.
Result<std::shared_ptr<const Rules>> shared_rules(const Family& family);

}  // namespace servoctl::drive
