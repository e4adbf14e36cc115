#pragma once

#include <functional>
#include <string_view>

#include "cli/terminal/console.hpp"

namespace servoctl::cli {

/// Shows a text on a terminal a window at a time: Space and Page Down go on by a window, Enter and the arrow
/// down by a line, q ends it, and so does a signal. The log of the console gets the whole text. `wait` waits
/// a while for the keyboard, and shows what else there is to be told.
void show_by_windows(Console& console, std::string_view text, const std::function<void()>& wait);

}  // namespace servoctl::cli
