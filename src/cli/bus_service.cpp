// What is done for the buses that are open while something else is waited for.
#include <poll.h>

#include <algorithm>
#include <vector>

#include "base/signal_wait.hpp"
#include "base/timespec.hpp"
#include "cli/bus_holder.hpp"

namespace servoctl::cli {

Duration BusHolder::serve() {
  // A session from which `beside` was taken is a thread's own for a while (cabinet::at_all()).
  for (auto* session : sessions())
    if (!session->options().beside) return Duration::max();
  // What nodes send is heard while somebody thinks: a heartbeat that nobody took in would count as lost.
  constexpr auto kHeard = std::chrono::milliseconds(50);
  auto out = open_.empty() ? Duration::max() : Duration(kHeard);
  for (auto* session : sessions()) {
    // What goes wrong is told to the next line.
    (void)session->listen();
    if (const auto next = session->next_event(); next != kNever)
      out = std::min(out, left_between(session->now(), next));
  }
  return out;
}

Duration BusHolder::keep_up() {
  auto out = Duration::max();
  for (auto* session : sessions()) {
    if (!session->options().beside) return Duration::max();
    if (const auto next = session->network().keep_up(); next != kNever)
      out = std::min(out, left_between(session->now(), next));
  }
  return out;
}

Duration BusHolder::serve_beside() {
  if (open_.size() < 2 || serving_beside_) return Duration::max();
  serving_beside_ = true;
  auto out = Duration::max();
  for (auto* session : sessions()) {
    if (session == session_ || !(session->network().must_go_on() || produces_sync(*session))) continue;
    (void)session->listen();
    if (const auto next = session->next_event(); next != kNever)
      out = std::min(out, left_between(session->now(), next));
  }
  serving_beside_ = false;
  return out;
}

bool BusHolder::wait_for(pollfd& wanted, Duration longest, const std::function<void(const Error&)>& lost) {
  std::vector<pollfd> fds{wanted};
  auto left = longest;
  for (auto* session : sessions()) {
    fds.push_back({session->network().poll_fd(), POLLIN, 0});
    if (const auto next = session->next_event(); next != kNever)
      left = std::min(left, left_between(session->now(), next));
  }
  if (wait_or_signal(fds, left) < 0) return false;
  for (auto* session : sessions())
    if (const auto heard = session->listen(); !heard && heard.error().code == Errc::bus) {
      lost(heard.error());
      lose(*session);
    }
  wanted.revents = fds.front().revents;
  return true;
}

}  // namespace servoctl::cli
