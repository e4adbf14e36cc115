#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace servoctl::cli {

/// When text on a terminal has colours: `automatic` where it is read on a terminal that has them, and
/// $NO_COLOR is not set.
enum class Colour : std::uint8_t { automatic, always, never };

/// `auto`, `always` or `never`; anything else is automatic.
Colour parse_colour(std::string_view word);

/// Whether what goes to this descriptor has colours.
bool has_colours(Colour wanted, int descriptor);

/// The text with colours where they have a meaning: `error:`, a fault and what failed red, `warning:` and
/// cautions yellow, what is in order green. Only words that stand alone in a line or a cell have one.
std::string coloured(std::string_view text);

}  // namespace servoctl::cli
