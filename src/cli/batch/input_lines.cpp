#include "cli/batch/input_lines.hpp"

#include <poll.h>
#include <unistd.h>

#include "base/printable.hpp"
#include "cli/terminal/signals.hpp"

namespace servoctl::cli {
namespace {

/// What nodes told while no line was there. With --json it stands in the document of the next line.
void tell_notices(Shell& shell) {
  const auto& settings = shell.defaults();
  if (settings.json) return;
  const auto family =
      settings.drive.empty() ? Result<const drive::Profile*>(nullptr) : shell.profile(settings.drive);
  for (const auto& notice : shell.take_notices(family ? *family : nullptr, settings.chinese))
    shell.console().note("notice: " + printable(notice) + "\n");
}

/// Until there is input or its end; false after a signal. A bus that is lost is told, and opened again by the
/// next line that needs it.
bool wait_for_input(Shell& shell) {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  while (!interrupted()) {
    const bool waited = shell.wait_for(input, std::chrono::hours(1),
                                       [&](const Error& error) { shell.report_error(error, false); });
    tell_notices(shell);
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
