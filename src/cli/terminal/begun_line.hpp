#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace servoctl::cli {

/// Who takes the line apart: what a backslash does within quotes.
enum class LineSyntax : std::uint8_t { servoctl, bash, zsh, fish };

/// A line of which the last word is not ready.
struct BegunLine {
  std::vector<std::string> words;  ///< Those before it, as split_words() reads them.
  std::string last;                ///< Without its quotes; empty behind a blank.
  std::size_t typed = 0;           ///< Bytes of the last one as it stands there, with quotes.
  char quote = 0;                  ///< The one that is still open.
  /// Bytes of `last` before the piece that a shell completes: what is behind the quote that is open, else
  /// behind the last sign that breaks words there.
  std::size_t kept = 0;
  bool comment = false;  ///< The end stands in a comment: there is no word to complete.
};

/// As split_words(), or as that shell does, for a line in which a quote may still be open. `breaks`: signs
/// that break a word for who asks, `:=` of $COMP_WORDBREAKS, but not for the program.
BegunLine begun_line(std::string_view line, std::string_view breaks = {},
                     LineSyntax syntax = LineSyntax::servoctl);

}  // namespace servoctl::cli
