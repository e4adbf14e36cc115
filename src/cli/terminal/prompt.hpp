#pragma once

#include "cli/shell.hpp"
#include "cli/terminal/console.hpp"

namespace servoctl::cli {

/// The interactive prompt: line editing, history kept between runs, completion. While the user types the bus
/// is listened to, and what nodes tell is shown above the line. `by_windows`: what is longer than the window
/// is shown a window at a time. Returns the exit code: 0, or 130 after SIGTERM or SIGHUP.
int run_prompt(Shell& shell, Console& console, bool by_windows);

}  // namespace servoctl::cli
