#pragma once

#include <unistd.h>

#include <string>
#include <string_view>

namespace servoctl {

/// What comes in through standard input, or through another descriptor, which stays open. In the place of
/// std::cin: to make the standard streams ready costs each start 26 page faults (bench/RESULTS.md).
class StandardInput {
 public:
  explicit StandardInput(int descriptor = STDIN_FILENO) : descriptor_(descriptor) {}

  /// A line, without its end; the last one needs none. False while none is here in whole.
  bool take_line(std::string& line);

  /// Waits for more; false at the end of the input, and where it cannot be read.
  bool read_more();

  /// All that is left, to the end or until it is more than `most` bytes.
  std::string take_rest(std::size_t most = std::string::npos);

 private:
  int descriptor_;
  bool ended_ = false;
  std::string buffer_;
  std::size_t taken_ = 0;  ///< Of the buffer.
};

/// That of the process: whoever reads it finds what those before it have left.
StandardInput& standard_input();

}  // namespace servoctl
