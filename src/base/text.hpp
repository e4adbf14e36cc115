#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace servoctl {

/// ASCII letters in lower case; other bytes unchanged.
std::string lower(std::string_view text);
std::string upper(std::string_view text);
bool equals_nocase(std::string_view a, std::string_view b);
bool starts_with_nocase(std::string_view text, std::string_view prefix);

/// Without spaces, tabs, CR and LF at both ends.
std::string_view trim(std::string_view text);

/// The parts between separators; a text without separator is one part, an empty text none.
std::vector<std::string_view> split(std::string_view text, char separator);
std::vector<std::string_view> split(std::string&& text,
                                    char separator) = delete;  // The parts would outlive the text.

/// Adds a part to a list in words; `separator` stands between the parts.
void append(std::string& list, std::string_view part, std::string_view separator = ", ");

/// Columns the text takes on a terminal: two for East Asian wide characters, none for combining ones. UTF-8;
/// a bad byte counts as one column.
std::size_t display_width(std::string_view text);

/// `text` filled with spaces to `width` columns; longer text is left as it is.
std::string pad_right(std::string_view text, std::size_t width);
std::string pad_left(std::string_view text, std::size_t width);

/// At most `width` columns of `text`; where something is cut, the last column is `…`.
std::string clip(std::string_view text, std::size_t width);

/// A word without blanks in pieces between which a line may be broken: beside wide characters, which have no
/// blanks between words; not within Latin words, not before a mark such as `，`, not in backticks.
std::vector<std::string_view> unbroken_pieces(std::string_view word);

/// `text` broken at spaces, and beside East Asian wide characters, so that no line is wider than `width`
/// columns (0: not broken); lines that this makes are indented. None begins with a mark such as `，` or `）`,
/// and what stands in backticks is not broken where there is room for it. Each line of `text` is broken by
/// itself.
std::string wrapped(std::string_view text, std::size_t indent, std::size_t width);

/// Levenshtein distance with transpositions, ASCII case ignored.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// Up to `most` of the candidates nearest to `text`, best first; those too far off to be meant are left out.
std::vector<std::string> nearest(std::string_view text, std::span<const std::string> candidates,
                                 std::size_t most = 3);

}  // namespace servoctl
