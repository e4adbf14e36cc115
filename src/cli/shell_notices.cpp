#include <algorithm>
#include <variant>

#include "base/format.hpp"
#include "base/printable.hpp"
#include "cli/shell.hpp"
#include "motion/left_energised.hpp"
#include "session/identify.hpp"
#include "show/notice.hpp"

namespace servoctl::cli {

namespace {

/// What a node answered was not what belongs to the request; or it took a segment as out of turn.
bool is_out_of_turn(const Error& error) {
  const auto kind = error.abort_code.value_or(0) >> 16U;
  return error.code == Errc::protocol || kind == 0x0503 || kind == 0x0504;
}

/// Two that answer at once break transfers, and one refuses what the other has: that there are two is the
/// cause to be told.
void blame_second_node(session::Session& session, Error& error) {
  if (!error.node || (error.code != Errc::protocol && error.code != Errc::sdo_abort)) return;
  const std::uint8_t nodes[] = {*error.node};
  if (is_out_of_turn(error)) (void)session::settle_duplicates(session, nodes, session::kThoroughly);
  if (session::refuse_duplicate(session, *error.node)) return;
  error.hint =
      "two nodes answer with this node-ID, which is the likely cause: disconnect one and give it another node-ID, then "
      "`scan`";
}

}  // namespace

using command::Needs;

std::vector<Message> Shell::take_notices(const drive::Profile* profile, bool chinese) {
  std::vector<Message> out;
  for (auto* session : bus_.sessions()) {
    const auto& names = bus_.names(*session);
    for (auto& notice : session->network().take_notices()) {
      names.put_into(notice);
      out.push_back(std::move(notice));
    }
    // The family of the line says nothing of another bus.
    const auto* family = session == bus_.session() ? profile : nullptr;
    for (const auto& event : session->take_events()) {
      auto text = show::notice_text(event, family, chinese, &session->network());
      names.put_into(text);
      // Whoever looks anew at a node sees the same two again; other events may well come twice.
      const bool doubled = std::holds_alternative<session::NodeEvent::Doubled>(event.what);
      if (!doubled || std::find(out.begin(), out.end(), text) == out.end()) out.push_back(std::move(text));
    }
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
  const auto least = run.command->brief ? session::kBriefly : session::kThoroughly;
  (void)session::settle_duplicates(*session, run.context.nodes, least);
}

/// Whether the bus of the line was lost. It is an error of the line where that `met` it, also in what it can
/// do without; one that was done before goes on.
bool Shell::tell_lost_bus(Run& run, bool met) {
  auto& errors = run.context.errors;
  auto* session = run.context.session;
  const auto of_bus = [](const Error& error) { return error.code == Errc::bus; };
  if (session == nullptr) return false;
  if (std::any_of(errors.begin(), errors.end(), of_bus)) return of_bus(errors.front());
  const auto heard = session->can() == nullptr ? Result<void>() : session->listen();
  if (heard || !of_bus(heard.error())) return false;
  if (met)
    errors.push_back(heard.error());
  else
    run.context.notices.push_back(message("{}, when what this line does was done", heard.error().message));
  return true;
}

/// What it may have done to the line: broken its transfers, or taken what was written.
void Shell::tell_second_node(Run& run) {
  auto* session = run.context.session;
  if (session == nullptr || cancelled()) return;
  auto& errors = run.context.errors;
  for (auto& error : errors) blame_second_node(*session, error);
  if (run.changes && (errors.empty() || errors.front().code != Errc::refused))
    for (const auto node : run.context.nodes) written_.emplace(opening(*session), node);
  for (auto& text : take_written_to_both(*session)) run.context.notices.push_back(std::move(text));
}

std::vector<std::string> Shell::take_written_to_both(session::Session& session) {
  std::vector<std::string> out;
  std::erase_if(written_, [&, here = opening(session)](const auto& written) {
    const auto [where, node] = written;
    if (where != here || session::refuse_duplicate(session, node)) return false;
    out.push_back(formatted(
        "node {}: what was written may have gone to both drives: read it back from each alone", node));
    return true;
  });
  return out;
}

void Shell::tell_energised(Run& run) {
  auto* session = run.context.session;
  if (session == nullptr || run.settings.dry_run) return;
  auto nodes = session->energised().nodes();
  for (const auto node : run.energised_before) nodes.erase(node);
  // What a motion says of a drive that fell silent is that already.
  for (const auto& error : run.context.errors)
    if (error.node && error.code == Errc::timeout && run.command->effect == command::Effect::moves)
      nodes.erase(*error.node);
  motion::tell_left_energised(run.context, nodes);
  for (const auto node : nodes) told_energised_.emplace(opening(*session), node);
}

/// The line was carried out; those that follow are too.
void Shell::tell_trace_failure(Run& run) {
  auto failure = bus_.take_trace_failure();
  if (!failure) return;
  if (!stays_open_) return run.context.errors.push_back(std::move(*failure));
  run.context.notices.push_back(failure->message + "; " + failure->hint);
  incomplete_trace_ = std::move(failure);
}

void Shell::hear_last_line() {
  auto* session = bus_.session();
  if (session == nullptr || unheard_.empty() || cancelled()) return;
  (void)session::settle_duplicates(*session, unheard_, session::kBriefly);
  tell_notices();
  const auto& names = bus_.names(*session);
  for (const auto& text : take_written_to_both(*session))
    console_->note("notice: " + printable(names.in(text)) + "\n");
}

void Shell::tell_notices() {
  const auto& settings = defaults();
  const auto family =
      settings.drive.empty() ? Result<const drive::Profile*>(nullptr) : profile(settings.drive);
  for (const auto& notice : take_notices(family ? *family : nullptr, settings.chinese))
    console_->note("notice: " + printable(notice.text()) + "\n");
}

/// Who shows something, or asks, keeps no bus waiting.
void Shell::show_wait(const session::Stretch* stretch, TimePoint now) {
  if (const std::unique_lock turn(turn_, std::try_to_lock); turn) progress_.update_wait(stretch, now);
}

}  // namespace servoctl::cli
