#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace servoctl::cli {

/// Whether the locale that the environment names ($LC_ALL, $LC_CTYPE, $LANG) has a character set other than
/// UTF-8. Where it names none, text is UTF-8.
bool locale_is_not_utf8();

/// The text in ASCII: `...` for an ellipsis, `deg`, `<=`, plots of dots. What has no such form, such as a
/// Chinese name, is written out: `\u901F`. A sign of several letters takes the blanks behind it, so that
/// columns stay where they are.
std::string ascii_form(std::string_view text);

/// The first `columns` of a line of ASCII; what is cut ends with `...`.
std::string ascii_clip(std::string_view text, std::size_t columns);

}  // namespace servoctl::cli
