#pragma once

#include <string>
#include <vector>

namespace servoctl::cli {

/// The program: one command, the prompt when no command is given and standard input is a terminal, command
/// lines from standard input otherwise. The answer is the exit code.
int run_program(const std::vector<std::string>& words);

}  // namespace servoctl::cli
