#include "cli/batch/input_lines.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <optional>

#include "base/signal_wait.hpp"
#include "cli/terminal/signals.hpp"

namespace servoctl::cli {
namespace {

/// Hears what has arrived; a bus that is lost is told, and opened again by the next line that needs it.
void serve(Shell& shell) {
  auto* session = shell.session();
  if (session == nullptr) return;
  const auto heard = session->listen();
  if (heard || heard.error().code != Errc::bus) return;
  shell.report_error(heard.error(), false);
  shell.lose_bus();
}

/// Until there is input or its end; false after a signal.
bool wait_for_input(Shell& shell) {
  while (!interrupted()) {
    auto* session = shell.session();
    pollfd fds[2] = {{STDIN_FILENO, POLLIN, 0},
                     {session == nullptr ? -1 : session->network().poll_fd(), POLLIN, 0}};
    std::optional<Duration> left;
    if (session != nullptr && session->next_event() != kNever)
      left = std::clamp<Duration>(session->next_event() - session->now(), Duration::zero(),
                                  std::chrono::hours(1));
    const int ready = wait_or_signal(fds, left);
    if (ready < 0) continue;
    serve(shell);
    if (fds[0].revents != 0) return true;
  }
  return false;
}

}  // namespace

bool next_line(Shell& shell, std::string& line) {
  if (std::cin.rdbuf()->in_avail() == 0 && !wait_for_input(shell)) return false;
  return !interrupted() && static_cast<bool>(std::getline(std::cin, line));
}

}  // namespace servoctl::cli
