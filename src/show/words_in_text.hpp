#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

/// Words that somebody looks for, in texts that are searchable() as they are.
namespace servoctl::show {

bool is_decimal_digit(char c);

/// The text in the form in which words are looked for: folded (base/folded.hpp), and without blanks beside
/// Chinese, where some manuals put them and others do not: `S 曲线` is `S曲线`.
std::string searchable(std::string_view text);

/// Several texts, each on its own: no word goes from one into the next.
std::string searchable(std::initializer_list<std::string_view> texts);

/// Whether the word begins a word of the text; a number, or a word of one or two letters, has to be all of
/// it: `15` is not in `0.15`, `-15`, `1500` or the name `P3-15`. Chinese knows no such borders.
bool has_word(std::string_view text, std::string_view word);

}  // namespace servoctl::show
