#pragma once

#include <termios.h>

#include <optional>

namespace servoctl::cli {

/// The mode of a terminal in which a line is edited: byte by byte, no echo; Ctrl-C and Ctrl-Z stay signals.
/// What was typed meanwhile is kept at every change.
class LineMode {
 public:
  explicit LineMode(int descriptor) : descriptor_(descriptor) {}
  LineMode(const LineMode&) = delete;
  LineMode& operator=(const LineMode&) = delete;
  ~LineMode() { leave(); }

  /// False where it is no terminal.
  bool enter();
  /// The terminal is as it was before enter().
  void leave();
  /// Sets the mode again where another program has changed it, such as a shell that went on meanwhile; true
  /// when that was so.
  bool renew();

 private:
  int descriptor_;
  std::optional<termios> before_;
};

}  // namespace servoctl::cli
