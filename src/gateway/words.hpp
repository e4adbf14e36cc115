#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace servoctl::gateway {

/// The words of a line of CiA 309-3, without what stands behind a `#`: a word in double quotes may hold
/// blanks, and two quotes in it are one. Empty when a quote is not closed, or something stands at a closing
/// one.
std::optional<std::vector<std::string>> split_words(std::string_view line);

/// The text as one word of a line: in double quotes.
std::string in_quotes(std::string_view text);

}  // namespace servoctl::gateway
