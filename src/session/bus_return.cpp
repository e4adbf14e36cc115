#include "session/bus_return.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "base/number.hpp"
#include "session/can_network.hpp"

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

Result<void> BusReturn::wait(const Error& lost, TimePoint end) {
  const auto since = session_->now();
  if (since < flickered_ + kAgain || sends_regularly() || !session_->energised().empty()) return fail(lost);
  // One that can be opened at once was perhaps never away: its queue is full, or it fails otherwise.
  if (session_->network().recover(since)) {
    session_->note_away();
    flickered_ = session_->now();
    return {};
  }
  tell_(false, fmt::format("{}: waiting for it to come back", lost.message));
  if (!reopen(end)) return fail(lost);
  session_->note_away();
  const auto time = session_->now();
  const auto seconds = std::chrono::duration<double>(time - since).count();
  tell_(true, fmt::format("{} is back after {} s", session_->url(), plain_number(seconds, 2)));
  return {};
}

}  // namespace servoctl::session
