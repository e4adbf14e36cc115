// How a shell ends: drives are let go, or told, and the buses closed.
#include <optional>
#include <utility>

#include "base/printable.hpp"
#include "cli/shell.hpp"
#include "motion/left_energised.hpp"

namespace servoctl::cli {

/// A drive that stays energised only while servoctl is there is held until the user ends it.
int Shell::hold() {
  if (!bus_.must_go_on()) return 0;
  console_->note("notice: process data go on, and the drive stays as it is: Ctrl-C ends it\n");
  auto& session = *bus_.session();
  while (!cancelled() && bus_.must_go_on()) {
    const auto stepped = session.step(session.now() + std::chrono::milliseconds(250));
    for (const auto& notice : take_notices(nullptr, false))
      console_->note("notice: " + printable(notice.text()) + "\n");
    if (!stepped) return report_error(stepped.error(), false);
  }
  if (cancelled()) {
    // This is how the user ends it.
    bus_.let_go();
    return 0;
  }
  return report_error(make_error(Errc::negative, "process data ended before you ended them",
                                 "the lines above say why; `status` shows the state of the slave"),
                      false);
}

std::optional<Errc> Shell::tell_energised_at_end() {
  // What was tried in vain was told.
  if (bus_.failure()) return std::nullopt;
  std::optional<Errc> out;
  for (auto* session : bus_.sessions()) {
    auto nodes = session->energised().nodes();
    std::erase_if(nodes, [&](auto node) { return told_energised_.contains({opening(*session), node}); });
    command::Context context;
    context.session = session;
    motion::tell_left_energised(context, nodes);
    const auto& names = bus_.names(*session);
    for (const auto& notice : context.notices)
      console_->err("notice: " + printable(names.sentence(notice)) + "\n");
    for (const auto& error : context.errors) {
      console_->err("error: " + printable(names.sentence(error.message)) + "\n");
      out = out.value_or(error.code);
    }
  }
  return out;
}

int Shell::close(int code) {
  hear_last_line();
  keep_restarts();
  // Here, so that a signal that comes while nobody reads finds the bus still open.
  console_->wait_for_reader();
  const bool ends_by_signal = cancelled() && (signal_interrupts_ || bus_.leaves_power());
  const auto interruption = exit_code(Errc::interrupted);
  if (ends_by_signal && code == 0) code = interruption;
  const bool lets_go = ends_by_signal || bus_.holds_drives();
  if (lets_go && !bus_.has_warned_of_all())
    bus_.let_go();
  else if (const auto unknown = lets_go ? std::nullopt : tell_energised_at_end(); unknown && code == 0)
    code = exit_code(*unknown);
  bus_.close();
  if (const auto why = bus_.failure(); why && (code == 0 || code == interruption)) code = exit_code(*why);
  auto failure = bus_.take_trace_failure();
  if (!failure) failure = std::exchange(incomplete_trace_, std::nullopt);
  if (!failure) return code;
  const auto mine = report_error(*failure, false);
  return code == 0 ? mine : code;
}

}  // namespace servoctl::cli
