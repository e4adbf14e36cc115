#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/shell.hpp"
#include "cli/terminal/candidate_list.hpp"

/// What the completion scripts of shells ask when Tab is pressed, and what they are told.
namespace servoctl::cli {

/// The first word of such a question, which stands for no command: `__complete SHELL …`.
inline constexpr std::string_view kTabQuestion = "__complete";

/// The answer to a question of the script for a shell. Nothing but files is opened, and what cannot be read
/// is left out; a question that is none has an empty answer.
///
/// `zsh BEGUN WORD…` and `fish BEGUN WORD…`: the word at the cursor as it is typed, with its quotes, and
/// those between the program's name and it, without. `bash TYPE COLUMNS BREAKS LINE`: $COMP_TYPE, the width
/// of the terminal, $COMP_WORDBREAKS and the line from the program's name to the cursor.
///
/// The first line of the answer is `files` where bash or zsh is to offer any file, `open` where nothing is to
/// be put behind the one word, `note TEXT` where no word can be offered but something can be said, else
/// `words`. The candidates follow, one a line, in the form of the shell.
std::string answer_tab(std::span<const std::string> question, Shell& shell);

/// The text as bash reads it at this place of a word: behind an open quote (`'` or `"`), else with a
/// backslash before all that it would not take as it is.
std::string bash_text(std::string_view text, char quote);

}  // namespace servoctl::cli
