#include "command/restarted_option.hpp"

#include <utility>

namespace servoctl::command {

Result<bool> says_restarted(const Context& context, const Arguments& arguments) {
  if (!arguments.has(kRestartedOption.name) || context.dry_run) return false;
  if (context.read_only)
    return fail(Errc::refused, "--restarted changes what servoctl remembers, and --read-only forbids it",
                "leave one of them out");
  return true;
}

show::OwedRestart note_owed(Context& context, std::uint8_t node, bool restarted) {
  if (restarted) show::OwedRestartFile(context.state_folder, context.session->url(), node).remove();
  auto owed = show::owed_restart(*context.session, context.state_folder, node);
  if (auto notice = show::owed_notice(context, node, owed); !notice.empty())
    context.notices.push_back(std::move(notice));
  return owed;
}

void add_owed(Context& context, std::uint8_t node, bool restarted, report::Record& out) {
  const auto owed = note_owed(context, node, restarted);
  if (!owed.values.empty())
    out.push_back({"restart_owed", show::owed_records(context.profile, owed.values), report::Show::json});
}

}  // namespace servoctl::command
