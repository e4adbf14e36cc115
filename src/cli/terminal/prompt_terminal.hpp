#pragma once

#include <poll.h>
#include <unistd.h>

#include <string_view>

#include "cli/terminal/console.hpp"
#include "cli/terminal/line_mode.hpp"

namespace servoctl::cli {

/// Whether the terminal understands more than text.
bool moves_cursor();

/// The terminal of a prompt: its mode while a line is typed, and while one runs; whether it takes what is
/// shown. Afterwards it is as it was, for whoever uses it next.
class PromptTerminal {
 public:
  explicit PromptTerminal(Console& console);
  PromptTerminal(const PromptTerminal&) = delete;
  PromptTerminal& operator=(const PromptTerminal&) = delete;
  ~PromptTerminal() { leave(); }

  /// A line is edited here; else the terminal edits it, as far as it does.
  bool edits() const { return edits_; }

  /// A line is typed: nobody is waited for.
  void begin();
  /// A line runs. Pastes stay marked: what is pasted meanwhile is still one when it is read.
  void pause();
  /// It is as it was before begin().
  void leave();

  enum class Change { none, size, stopped };
  /// What has become of it since the last call: another size, or the process was stopped and goes on. What is
  /// on the screen is not known behind `stopped`.
  Change take_change();

  void draw(std::string_view text) { console_->draw(text); }
  /// What is no result stays out of a file that takes the results.
  void say(std::string_view text);
  /// Whether text waits because the terminal is held, or slow.
  bool is_behind() { return console_->is_behind(); }
  /// To wait until it takes more.
  pollfd room() const { return {shows_output_ ? STDOUT_FILENO : STDERR_FILENO, POLLOUT, 0}; }

 private:
  Console* console_;
  LineMode mode_{STDIN_FILENO};
  bool shows_output_ = ::isatty(STDOUT_FILENO) == 1;
  bool edits_;
  bool marks_ = false;  ///< Pastes are marked.
  unsigned resumed_ = 0;
  Screen::Size size_;
};

}  // namespace servoctl::cli
