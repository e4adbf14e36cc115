#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace servoctl::command {

/// One `ID=VALUE` of `param set`. The views are of the words.
struct Assignment {
  std::string_view id;
  std::string_view value;
};

/// Reads `ID VALUE`, or any number of `ID=VALUE`. Errc::usage for anything else.
Result<std::vector<Assignment>> parse_assignments(std::span<const std::string> words);

}  // namespace servoctl::command
