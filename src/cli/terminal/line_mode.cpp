#include "cli/terminal/line_mode.hpp"

#include "cli/terminal/signals.hpp"

namespace servoctl::cli {
namespace {

termios byte_by_byte(termios mode) {
  mode.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO | IEXTEN);
  mode.c_iflag &= ~static_cast<tcflag_t>(IXON);  // Ctrl-S searches on.
  mode.c_iflag |= static_cast<tcflag_t>(ICRNL);
  mode.c_oflag |= static_cast<tcflag_t>(OPOST | ONLCR);
  mode.c_cc[VMIN] = 1;
  mode.c_cc[VTIME] = 0;
  return mode;
}

}  // namespace

bool LineMode::enter() {
  termios now{};
  if (::tcgetattr(descriptor_, &now) != 0) return false;
  if (!before_) {
    before_ = now;
    keep_terminal_mode(descriptor_, now);
  }
  const auto wanted = byte_by_byte(now);
  return ::tcsetattr(descriptor_, TCSANOW, &wanted) == 0;
}

void LineMode::leave() {
  if (!before_) return;
  (void)::tcsetattr(descriptor_, TCSANOW, &*before_);
  forget_terminal_mode();
  before_.reset();
}

bool LineMode::renew() {
  termios now{};
  if (!before_ || ::tcgetattr(descriptor_, &now) != 0 || (now.c_lflag & ICANON) == 0) return false;
  return enter();
}

}  // namespace servoctl::cli
