#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace servoctl::cli {

/// Splits a command line into words as a shell does: blanks separate, 'single' and "double" quotes keep them
/// together, a backslash takes the next character as it is (not in single quotes), `#` at the start of a word
/// begins a comment. Errc::usage when a quote is not closed.
Result<std::vector<std::string>> split_words(std::string_view line);

}  // namespace servoctl::cli
