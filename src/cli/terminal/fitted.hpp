#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace servoctl::cli {

/// Lines for people in at most `width` columns (0: as they are), broken at blanks. What goes on stands below
/// where the text of the line began: behind `notice: `, or behind the first column.
std::string fitted(std::string_view text, std::size_t width);

}  // namespace servoctl::cli
