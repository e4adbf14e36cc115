#include "cli/batch/input_lines.hpp"

#include <poll.h>
#include <unistd.h>

#include "cli/terminal/signals.hpp"

namespace servoctl::cli {
namespace {

/// Until there is input or its end; false after a signal. A bus that is lost is told, and opened again by the
/// next line that needs it.
bool wait_for_input(Shell& shell) {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  while (!interrupted()) {
    const bool waited = shell.wait_for(input, std::chrono::hours(1),
                                       [&](const Error& error) { shell.report_error(error, false); });
    // With --json they stand in the document of the next line.
    if (!shell.defaults().json) shell.tell_notices();
    if (waited && input.revents != 0) return true;
  }
  return false;
}

}  // namespace

bool next_line(Shell& shell, StandardInput& input, std::string& line) {
  bool more = true;
  while (!input.take_line(line)) {
    if (!more || !wait_for_input(shell)) return false;
    more = input.read_more();
  }
  return !interrupted();
}

}  // namespace servoctl::cli
