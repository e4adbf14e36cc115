#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace servoctl::cli {

/// What a shell takes for the pager of the user: $SERVOCTL_PAGER, else $PAGER, else `less -FRX` where there
/// is less. Empty where none is wanted (an empty value, `cat`), or the terminal has no cursor to move.
std::string pager_command();

/// Whether the user wants what is long a window at a time: not with an empty value of these, `cat`, or a
/// terminal without a cursor.
bool wants_pages();

/// Whether a line says --no-pager.
bool refuses_pager(const std::vector<std::string>& words);

/// Whether a folder of $PATH has this program.
bool is_in_path(std::string_view program);

/// Whether the text and a line behind it need more than a window of this size.
bool is_longer_than(std::string_view text, std::size_t columns, std::size_t rows);

/// Shows the text through `sh -c COMMAND` and waits for its end, however early that is; Ctrl-C and Ctrl-\ are
/// for the pager meanwhile, and the terminal has its mode back afterwards. False where it could not be
/// started, or says that it failed: then nobody has seen the text.
bool show_through(const std::string& command, std::string_view text);

}  // namespace servoctl::cli
