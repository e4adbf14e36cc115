#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/result.hpp"

namespace servoctl::cli {

/// Why the words from `first` on name no command, and which one may be meant; words[first] is there.
Error unknown_command(const std::vector<std::string>& words, std::size_t first);

}  // namespace servoctl::cli
