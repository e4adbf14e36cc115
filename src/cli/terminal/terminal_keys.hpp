#pragma once

#include <termios.h>

#include <memory>

#include "command/keys.hpp"

namespace servoctl::cli {

/// Takes the keys of a terminal one by one while it lives: no echo, no Enter; Ctrl-C stays a signal.
class TerminalKeys final : public command::Keys {
 public:
  /// Null when `descriptor` is no terminal.
  static std::unique_ptr<command::Keys> open(int descriptor);
  ~TerminalKeys() override;

  Key take() override;
  char character() const override { return character_; }

 private:
  TerminalKeys(int descriptor, const termios& before);
  /// The next byte that was typed; -1 for none, -2 when the terminal is gone.
  int next_byte();
  /// The mode in which they are taken, again: Ctrl-Z gave the terminal back.
  void resume();

  int descriptor_;
  termios before_;
  unsigned resumed_;
  char character_ = '\0';
};

}  // namespace servoctl::cli
