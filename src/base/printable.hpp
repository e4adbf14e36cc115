#pragma once

#include <string>
#include <string_view>

namespace servoctl {

/// `text` as it may stand in a line on a terminal, in a page or in a log, whoever wrote it: valid UTF-8 in
/// which nothing moves the cursor, turns the direction of the text or hides (is_hidden_or_control()). Such a
/// character is written out: `\n`, `\r`, `\t`, `\x1B` below U+0080, `\u202E`, `\U000E0041`; a byte that is
/// part of no UTF-8 character is `\x9B`. Everything else stands as it is, backslashes too: what is printable
/// stays as it is.
std::string printable(std::string_view text);

/// The same for text of several lines whose line breaks and tabs are ours.
std::string printable_lines(std::string_view text);

}  // namespace servoctl
