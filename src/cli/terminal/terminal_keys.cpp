#include "cli/terminal/terminal_keys.hpp"

#include <poll.h>
#include <unistd.h>

#include <utility>

#include "cli/terminal/signals.hpp"

namespace servoctl::cli {
namespace {

constexpr int kNothing = -1;
constexpr int kGone = -2;
constexpr int kEscape = 0x1B;

termios key_by_key(termios mode) {
  mode.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  // Ctrl-S ends the motion as any other key does, and holds nothing back.
  mode.c_iflag &= ~static_cast<tcflag_t>(IXON);
  mode.c_cc[VMIN] = 0;
  mode.c_cc[VTIME] = 0;
  return mode;
}

/// What stands between `ESC [` and the end of a key.
bool is_parameter(int byte) { return (byte >= '0' && byte <= '9') || byte == ';'; }

}  // namespace

TerminalKeys::TerminalKeys(int descriptor, const termios& before)
    : descriptor_(descriptor), before_(before), resumed_(times_resumed()) {}

std::unique_ptr<command::Keys> TerminalKeys::open(int descriptor) {
  termios before{};
  if (::tcgetattr(descriptor, &before) != 0) return nullptr;
  const auto raw = key_by_key(before);
  keep_terminal_mode(descriptor, before);
  // What was typed before nobody meant as a key that moves something.
  if (::tcsetattr(descriptor, TCSAFLUSH, &raw) != 0) {
    forget_terminal_mode();
    return nullptr;
  }
  return std::unique_ptr<command::Keys>(new TerminalKeys(descriptor, before));
}

TerminalKeys::~TerminalKeys() {
  (void)::tcsetattr(descriptor_, TCSAFLUSH, &before_);
  forget_terminal_mode();
}

void TerminalKeys::resume() {
  if (const auto now = times_resumed(); std::exchange(resumed_, now) == now) return;
  const auto raw = key_by_key(before_);
  (void)::tcsetattr(descriptor_, TCSAFLUSH, &raw);
}

int TerminalKeys::next_byte() {
  pollfd input{descriptor_, POLLIN, 0};
  if (::poll(&input, 1, 0) <= 0) return kNothing;
  unsigned char byte = 0;
  return ::read(descriptor_, &byte, 1) == 1 ? byte : kGone;
}

TerminalKeys::Key TerminalKeys::take() {
  resume();
  const int first = next_byte();
  character_ = first > 0 && first != kEscape ? static_cast<char>(first) : '\0';
  if (first == kNothing) return Key::none;
  if (first == kGone) return Key::lost;
  if (first != kEscape) return Key::other;
  const int second = next_byte();
  if (second != '[' && second != 'O') return Key::other;  // Cursor keys, or those of application mode.
  const int third = next_byte();
  switch (third) {
    case 'A': return Key::up;
    case 'B': return Key::down;
    case 'C': return Key::right;
    case 'D': return Key::left;
    default: break;
  }
  // `5~` is page up; with Ctrl, `5;5~`, and all others are other keys, whole.
  const int fourth = is_parameter(third) ? next_byte() : third;
  for (int last = fourth; is_parameter(last);) last = next_byte();
  if (fourth != '~') return Key::other;
  return third == '5' ? Key::page_up : third == '6' ? Key::page_down : Key::other;
}

}  // namespace servoctl::cli
