#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

/// Numbers as tables and panels print them, and as people type them. All texts are folded (base/folded.hpp).
namespace servoctl::show {

/// Whether the text is a hexadecimal number that says so: `0x1b`, `1bh`; `each` is a word.
bool is_marked_hex(std::string_view text);

/// Whether a cell is the number that was typed, whatever zeros are before it: `028` is `28`, `0x1b` is
/// `001bh`. Without a mark digits are those of the cell (`80` is `80h`), with one the value counts as well
/// (`0x1c` is `28`). Of a cell that lists numbers or ranges (`1, 9`, `4-6`) each counts.
bool is_number(std::string_view cell, std::string_view typed);

/// Whether a cell is the hexadecimal number that was typed, with or without a mark: `001b` is `0x001b`, and
/// no decimal number, list or range.
bool is_hex_number(std::string_view cell, std::string_view typed);

/// Whether a name is counted by the decimal number that was typed: `funin.28`, `er.15`, `al-15` and `sm2`
/// are. Neither is a name with two numbers (`er15-0`, `p0.15`), nor one whose letters may be digits (`a5`).
bool is_counted_by(std::string_view name, std::string_view typed);

/// A code of at most so many hexadecimal digits, however it is marked as such.
std::optional<std::uint64_t> code_in(std::string_view text, std::size_t most_digits);

}  // namespace servoctl::show
