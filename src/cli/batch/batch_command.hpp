#pragma once

#include <istream>
#include <string>
#include <vector>

#include "cli/shell.hpp"

namespace servoctl::cli {

/// Whether the line is `run FILE` (and does not ask for its help).
bool is_batch(const std::vector<std::string>& words);

/// Runs the batch file the line names, with the options of the line as the defaults of all its lines; `input`
/// is what `-` stands for, null where that is not to be had. What is wrong in any line is told before the
/// first one is run. The defaults of the shell are the same afterwards. The answer is the exit code.
int run_batch(Shell& shell, const std::vector<std::string>& words, std::istream* input);

}  // namespace servoctl::cli
