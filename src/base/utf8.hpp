#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace servoctl {

/// A character at the beginning of a text.
struct CodePoint {
  std::optional<char32_t> value;  ///< Empty for a byte that is part of no UTF-8 character.
  std::size_t size = 1;           ///< Bytes it takes.
};

/// The first character of a text that is not empty. Overlong forms, surrogates and what lies beyond U+10FFFF
/// are none (Unicode 15, table 3-7): one byte of them is taken.
CodePoint decode_utf8(std::string_view text);

/// Appends a character that is no surrogate and not above U+10FFFF.
void append_utf8(char32_t character, std::string& out);

/// Whether the text is UTF-8 throughout.
bool is_utf8(std::string_view text);

/// Whether a character of the text is Chinese, or one of the marks of Chinese text: U+3000 to U+9FFF.
bool has_chinese(std::string_view text);

/// Whether the first, or the last, character is one of these; `…` is none.
bool begins_in_chinese(std::string_view text);
bool ends_in_chinese(std::string_view text);

/// Whether the last character is Chinese, and none of its marks.
bool ends_with_character(std::string_view text);

/// Columns the character takes on a terminal: two for East Asian wide ones, none for combining ones.
std::size_t columns(char32_t c);

/// Characters that text may not bring to a terminal, a page or a log: controls (C0, DEL, C1), those that
/// change the direction of what stands beside them, line and paragraph separators, what takes no place and so
/// hides (Default_Ignorable_Code_Point: zero-width characters, tags, variation selectors), noncharacters and
/// surrogates.
bool is_hidden_or_control(char32_t c);

}  // namespace servoctl
