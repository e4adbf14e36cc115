#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cli/shell.hpp"

namespace servoctl::cli {

/// Gives standard input to its end; empty where that is not to be had.
using StandardText = std::function<std::string()>;

/// Whether the line is `run FILE` (and does not ask for its help).
bool is_batch(const std::vector<std::string>& words);

/// Runs the batch file the line names, with the options of the line as the defaults of all its lines; `input`
/// is what `-` stands for. What is wrong in any line is told before the
/// first one is run. The defaults of the shell are the same afterwards. The answer is the exit code.
int run_batch(Shell& shell, const std::vector<std::string>& words, const StandardText& input);

}  // namespace servoctl::cli
