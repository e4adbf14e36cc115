#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace servoctl {

/// Text in the form in which words are compared: ASCII in lower case, full-width forms (U+FF01 to U+FF5E, the
/// ideographic space) as the ASCII characters they stand for, white space as single blanks, none at the ends.
std::string folded(std::string_view text);

/// `text` in lines of at most `width` columns: broken at blanks, and between East Asian wide characters, but
/// not before what closes and not behind what opens. A piece that is wider stands on a line of its own. One
/// line at least.
std::vector<std::string> broken_lines(std::string_view text, std::size_t width);

}  // namespace servoctl
