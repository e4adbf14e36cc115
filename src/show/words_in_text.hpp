#pragma once

#include <string_view>

/// Words that somebody looks for, in texts that are folded (base/folded.hpp) as they are.
namespace servoctl::show {

bool is_decimal_digit(char c);

/// Whether the word begins a word of the text; a number, or a word of one or two letters, has to be all of
/// it: `15` is not in `0.15`, `-15`, `1500` or the name `P3-15`. Chinese knows no such borders.
bool has_word(std::string_view text, std::string_view word);

}  // namespace servoctl::show
