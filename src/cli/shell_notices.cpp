#include "base/printable.hpp"
#include "cli/shell.hpp"
#include "session/identify.hpp"
#include "show/notice.hpp"

namespace servoctl::cli {

using command::Needs;

std::vector<std::string> Shell::take_notices(const drive::Profile* profile, bool chinese) {
  std::vector<std::string> out;
  for (auto* session : bus_.sessions()) {
    const auto& names = bus_.names(*session);
    for (const auto& notice : session->network().take_notices()) out.push_back(names.in(notice));
    // The family of the line says nothing of another bus.
    const auto* family = session == bus_.session() ? profile : nullptr;
    for (const auto& event : session->take_events())
      out.push_back(names.in(show::notice_text(event, family, chinese, &session->network())));
  }
  return out;
}

/// A line of its own ends before a second node of the same number may have answered.
void Shell::hear_second_node(const Run& run) {
  auto* session = run.context.session;
  unheard_.clear();
  if (session == nullptr || !includes(run.command->needs, Needs::node) || cancelled()) return;
  // Another line may follow, and tells it; or this was the last one.
  if (stays_open_) {
    unheard_ = run.context.nodes;
    return;
  }
  // What it cannot tell is told by the next line.
  (void)session::settle_duplicates(*session, run.context.nodes, session::kBriefly);
}

void Shell::hear_last_line() {
  auto* session = bus_.session();
  if (session == nullptr || unheard_.empty() || cancelled()) return;
  (void)session::settle_duplicates(*session, unheard_, session::kBriefly);
  tell_notices();
}

void Shell::tell_notices() {
  const auto& settings = defaults();
  const auto family =
      settings.drive.empty() ? Result<const drive::Profile*>(nullptr) : profile(settings.drive);
  for (const auto& notice : take_notices(family ? *family : nullptr, settings.chinese))
    console_->note("notice: " + printable(notice) + "\n");
}

}  // namespace servoctl::cli
