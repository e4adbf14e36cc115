#pragma once

#include <string>

#include "base/standard_input.hpp"
#include "cli/shell.hpp"

namespace servoctl::cli {

/// The next line of an input that is no terminal. While none is there the bus is served: what it
/// produces goes on, what nodes tell is told, and nobody who sends waits for us. False at the end of the
/// input, and after a signal.
bool next_line(Shell& shell, StandardInput& input, std::string& line);

}  // namespace servoctl::cli
