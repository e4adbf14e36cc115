#include "cli/console.hpp"

#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <string>

#include "base/timespec.hpp"
#include "cli/signals.hpp"
#include "cli/terminal_keys.hpp"

namespace servoctl::cli {
namespace {

/// How late Ctrl-C may be noticed when it comes just before the wait begins.
constexpr Duration kSlice = std::chrono::milliseconds(50);

}  // namespace

/// Waits until a line was typed; false after Ctrl-C.
bool StandardConsole::line_is_there() const {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  while (!interrupted()) {
    const auto wait = to_timespec(std::min(serve(), kSlice));
    if (::ppoll(&input, 1, &wait, nullptr) > 0) return true;
  }
  return false;
}

/// Up to Enter, the end of the input, or a signal.
std::string StandardConsole::typed_line() const {
  std::string out;
  if (!line_is_there()) return out;
  for (int c = std::getchar(); c != EOF && c != '\n'; c = std::getchar()) out += static_cast<char>(c);
  if (std::feof(stdin) != 0 || std::ferror(stdin) != 0) std::clearerr(stdin);
  return out;
}

void StandardConsole::out(std::string_view text) {
  if (live_) return live_out_.offer(text);
  const auto all = live_out_.take_waiting().append(text);
  const bool written =
      std::fwrite(all.data(), 1, all.size(), stdout) == all.size() && std::fflush(stdout) == 0;
  if (!written && write_error_ == 0) write_error_ = errno;
}

void StandardConsole::err(std::string_view text) {
  if (live_) return live_err_.offer(text);
  const auto all = live_err_.take_waiting().append(text);
  std::fwrite(all.data(), 1, all.size(), stderr);
}

void StandardConsole::set_live(bool live) {
  live_ = live;
  for (auto* output : {&live_out_, &live_err_}) {
    if (live)
      output->open();
    else
      output->close();
  }
}

void StandardConsole::show_progress(std::string_view line) {
  if (::isatty(STDERR_FILENO) == 1) err("\r\033[K" + std::string(line));
}

bool StandardConsole::ask(std::string_view question) {
  if (!can_ask()) return false;
  err(std::string(question) + " [y/N] ");
  const auto answer = typed_line();
  return answer == "y" || answer == "Y" || answer == "yes";
}

void StandardConsole::pause(std::string_view text) {
  err(std::string(text) + " [Enter] ");
  typed_line();
}

bool StandardConsole::can_ask() const { return ::isatty(STDIN_FILENO) == 1 && ::isatty(STDERR_FILENO) == 1; }

std::unique_ptr<commands::Keys> StandardConsole::open_keys() {
  return can_ask() ? TerminalKeys::open(STDIN_FILENO) : nullptr;
}

std::size_t StandardConsole::width() const {
  winsize size{};
  if (::isatty(STDOUT_FILENO) != 1 || ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0)
    return 0;
  return size.ws_col;
}

}  // namespace servoctl::cli
