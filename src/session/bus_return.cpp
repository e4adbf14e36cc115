#include "session/bus_return.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "base/number.hpp"
#include "session/can_network.hpp"
#include "session/identify.hpp"

namespace servoctl::session {
namespace {

/// In one try of the network to come back: so late is an interrupt answered.
constexpr Duration kTry = std::chrono::milliseconds(100);
/// A try that ends sooner than this says that there is nothing to wait for.
constexpr Duration kNoTry = std::chrono::milliseconds(5);
/// Lost again so soon behind that, it is not waited for any more.
constexpr Duration kAgain = std::chrono::seconds(3);

}  // namespace

BusReturn::Tell BusReturn::to_people(Session& session) {
  return [&session](bool, std::string_view line) {
    if (session.options().tell) session.options().tell(line);
  };
}

bool BusReturn::sends_regularly() const {
  const auto* can = session_->can();
  return session_->network().must_go_on() ||
         (can != nullptr && (can->sync() != nullptr || can->heartbeat_node().has_value()));
}

/// Errc::interrupted; Errc::bus where it is not back.
Result<void> BusReturn::reopen(TimePoint end) {
  const auto& options = session_->options();
  for (;;) {
    if (options.cancelled && options.cancelled()) return fail(Errc::interrupted, "interrupted");
    const auto asked = session_->now();
    auto slice = kTry;
    if (options.beside) slice = std::clamp(options.beside(), kNoTry, kTry);
    auto back = session_->network().recover(std::min(asked + slice, end));
    const auto time = session_->now();
    if (back || time >= end || time < asked + std::min(slice, kNoTry)) return back;
  }
}

std::vector<Identity> BusReturn::known() const {
  std::vector<Identity> out;
  for (const auto node : nodes_)
    if (const auto* one = session_->identities().find(node, session_->watch().boots(node)))
      out.push_back(*one);
  return out;
}

Result<void> BusReturn::hold(std::span<const Identity> before) {
  for (const auto& one : before) {
    auto now = read_identity(*session_, one.node);
    if (!now && now.error().code == Errc::bus) return fail(now.error());
    if (!now) continue;
    // What tells the family does not ask for these.
    if (!one.revision) now->revision.reset();
    if (!one.serial) now->serial.reset();
    auto change = different_number(one, *now);
    const bool both_named = !one.device_name.empty() && !now->device_name.empty();
    if (change.empty() && both_named && one.device_name != now->device_name) change = "its name (1008h)";
    if (!change.empty())
      return fail(drive_error(
          Errc::refused, one.node,
          message("another drive is there than before the bus was lost: {} is another", change),
          "`scan --long` shows who is there; then type the line anew, with the family of this drive"));
  }
  return {};
}

Result<void> BusReturn::wait(const Error& lost, TimePoint end) {
  const auto since = session_->now();
  if (since < flickered_ + kAgain || sends_regularly() || !session_->energised().empty()) return fail(lost);
  tell_(false, formatted("{}: waiting until it can be used again", lost.message.text()));
  const auto before = known();
  // One that can be opened at once was perhaps never away: its queue is full, or it fails otherwise.
  const bool at_once = session_->network().recover(since).has_value();
  if (!at_once && !reopen(end)) return fail(lost);
  session_->note_away();
  const auto seconds = std::chrono::duration<double>(session_->now() - since).count();
  tell_(true, at_once
                  ? formatted("{} was opened anew at once", session_->url())
                  : formatted("{} can be used again after {} s", session_->url(), plain_number(seconds, 2)));
  const auto held = hold(before);
  if (at_once) flickered_ = session_->now();
  // Lost again: whoever reads next meets it.
  if (!held && held.error().code == Errc::bus && !at_once) return {};
  return held;
}

}  // namespace servoctl::session
