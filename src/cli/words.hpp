#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace servoctl::cli {

/// What stands for `${NAME}`, or why nothing does.
using VariableLookup = std::function<Result<std::string>(std::string_view name)>;

/// More than this is no command line, however often it names a variable.
inline constexpr std::size_t kLongestLine = 1U << 20U;

/// Splits a command line into words as a shell does: blanks separate, 'single' and "double" quotes keep them
/// together, a backslash takes the next character as it is (not in single quotes), `#` at the start of a word
/// begins a comment. With `variables`, `${NAME}` is replaced (not in single quotes); a value stays one word,
/// whatever stands in it. Errc::usage when a quote or a brace is not closed, and when values make the line
/// longer than kLongestLine; errors of `variables`.
Result<std::vector<std::string>> split_words(std::string_view line, const VariableLookup& variables = {});

/// Puts values in the place of the `${NAME}` of one line, of which there may be so many as fit kLongestLine.
class VariableExpansion {
 public:
  /// Without `variables` nothing is replaced. They must live as long as this does.
  explicit VariableExpansion(const VariableLookup& variables) : variables_(&variables) {}

  /// Whether a variable begins at `at`.
  bool begins(std::string_view line, std::size_t at) const {
    return *variables_ && line.substr(at).starts_with("${");
  }
  /// The value of the variable that begins at `at`; `at` is moved to its `}`. Errc::usage when the brace is
  /// not closed, and when the values make the line longer than kLongestLine; errors of the lookup.
  Result<std::string> take(std::string_view line, std::size_t& at);

 private:
  const VariableLookup* variables_;
  std::size_t filled_in_ = 0;  ///< Characters that came of variables.
};

/// A line that split_words() takes apart into these words.
std::string join_words(std::span<const std::string> words);

}  // namespace servoctl::cli
