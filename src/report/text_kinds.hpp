#pragma once

#include <cstddef>
#include <string_view>

#include "report/phrase.hpp"

/// What a part of a text may be, as far as its form tells.
namespace servoctl::report {

bool has_letters(std::string_view text);

/// `json`, `` `fault show` ``: without blanks, or in backticks.
bool is_name(std::string_view text);

/// `node 3`, `node 3, object 0x6041:0`, `lift`, `can0`, `a.txt:3`: where something happened.
bool is_place(std::string_view text);

/// The end of an English plural.
bool is_plural(std::string_view ending);

/// Whether what stands at this place of a phrase is more than one thing: `conflict: PDO of node 3 …` is not
/// one thing of node 3, `node 1: 7 (8)` is no node, `… within 5 ms; …` no time, and `7) (node 1` nothing at
/// all.
bool takes_too_much(const Phrase& phrase, std::size_t place, std::string_view value);

}  // namespace servoctl::report
