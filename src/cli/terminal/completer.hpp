#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cli/shell.hpp"

namespace servoctl::cli {

/// What may stand at the end of a line.
struct Completions {
  std::vector<std::string> words;  ///< All that begin with what is typed, ASCII case ignored.
  bool files = false;              ///< A file name is asked for: let the line editor look at the disk.
};

/// Completes the last word of `line` (empty after a blank) from the registry and from the data of the drive
/// in use: commands, options, choices, objects, panel numbers, families, buses.
Completions complete(std::string_view line, Shell& shell);

}  // namespace servoctl::cli
