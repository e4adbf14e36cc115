#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace servoctl::cabinet {

/// Whether an axis or a group may be called so: a letter first (of any script), nothing that separates words,
/// hides or stands for something else, and not `all`.
bool is_name(std::string_view name);

/// The names that `feeder{1-40}` stands for; one without braces stands for itself. `{01-40}` keeps the width.
/// Errc::file for braces that hold no rising range of at most 127.
Result<std::vector<std::string>> expand_name(const std::string& pattern);

}  // namespace servoctl::cabinet
