#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cli/shell.hpp"

namespace servoctl::cli {

/// One of the words that only make sense where several lines follow each other: `use`, `drive`, `bus`,
/// `exit`.
struct PromptWord {
  std::string_view name;
  std::string_view argument;  ///< `NODE`; empty: takes none.
  std::string_view help;
};
std::vector<PromptWord> prompt_words();

/// Runs lines as the prompt and a pipe give them: commands, and the words above, which set what holds for the
/// lines after them.
class LineRunner {
 public:
  explicit LineRunner(Shell& shell) : shell_(&shell) {}

  /// Exit code of the line; 0 for an empty one or a comment.
  int run(std::string_view line);
  bool wants_exit() const { return exit_; }

 private:
  int use(const std::string& nodes);
  int drive(const std::string& family);
  int bus(const std::string& url);

  Shell* shell_;
  bool exit_ = false;
};

}  // namespace servoctl::cli
