#pragma once

#include <string_view>

#include "cli/shell.hpp"

namespace servoctl::cli {

/// Runs lines as the prompt and a pipe give them: commands, batch files, and the words of prompt_words.hpp,
/// which set what holds for the lines after them.
class LineRunner {
 public:
  explicit LineRunner(Shell& shell) : shell_(&shell) {}

  /// Exit code of the line; 0 for an empty one or a comment.
  int run(std::string_view line);
  bool wants_exit() const { return exit_; }

 private:
  Shell* shell_;
  bool exit_ = false;
};

}  // namespace servoctl::cli
