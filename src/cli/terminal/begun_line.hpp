#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace servoctl::cli {

/// A line of which the last word is not ready.
struct BegunLine {
  std::vector<std::string> words;  ///< Those before it, as split_words() reads them.
  std::string last;                ///< Without its quotes; empty behind a blank.
  std::size_t typed = 0;           ///< Bytes of the last one as it stands there, with quotes.
  char quote = 0;                  ///< The one that is still open.
  /// Bytes of `last` before the piece that a shell completes: what is behind the quote that is open, else
  /// behind the last sign that breaks words there.
  std::size_t kept = 0;
};

/// As split_words(), for a line in which a quote may still be open. `breaks`: signs that break a word for who
/// asks, `:=` of $COMP_WORDBREAKS, but not for the program.
BegunLine begun_line(std::string_view line, std::string_view breaks = {});

}  // namespace servoctl::cli
