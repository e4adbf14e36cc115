#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/shell.hpp"

namespace servoctl::cli {

/// Runs lines as the prompt and a pipe give them: commands, batch files, and the words of prompt_words.hpp,
/// which set what holds for the lines after them.
class LineRunner {
 public:
  /// Shows the outcome of a command, whose words these are; the exit code.
  using Show = std::function<int(const Outcome& outcome, const std::vector<std::string>& words)>;

  /// Without `show` all of it is shown at once.
  explicit LineRunner(Shell& shell, Show show = {}) : shell_(&shell), show_(std::move(show)) {}

  /// Exit code of the line; 0 for an empty one or a comment.
  int run(std::string_view line);
  bool wants_exit() const { return exit_; }

 private:
  Shell* shell_;
  Show show_;
  bool exit_ = false;
};

}  // namespace servoctl::cli
