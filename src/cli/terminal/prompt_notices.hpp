#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "cli/shell.hpp"

namespace servoctl::cli {

/// What nodes tell while nobody asks, kept until the terminal takes it.
class PromptNotices {
 public:
  /// Takes what was heard on the buses since the last call.
  void hear(Shell& shell);
  bool empty() const { return waiting_.empty(); }
  /// All that wait, and how many were left out because the terminal took nothing for too long.
  std::vector<Message> give();

 private:
  std::vector<Message> waiting_;
  std::size_t left_out_ = 0;
};

}  // namespace servoctl::cli
