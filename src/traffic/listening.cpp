#include "traffic/listening.hpp"

#include <algorithm>
#include <utility>

#include "session/can_network.hpp"
#include "session/stretch.hpp"

namespace servoctl::traffic {
namespace {

/// How late what was gathered is shown, and an end by --for noticed, on a bus that is never silent.
constexpr Duration kSlice = std::chrono::milliseconds(50);

Result<void> listen_until(session::Session& session, TimePoint end, const Listener& listener) {
  auto shown = session.now();
  for (;;) {
    const auto due = listener.next ? listener.next() : kNever;
    const auto stepped = session.step(std::min({end, due, shown + kSlice}));
    if (!stepped && stepped.error().code == Errc::interrupted) break;
    if (!stepped) return fail(stepped.error());
    const auto* network = session.can();
    const auto frame = network == nullptr ? std::optional<can::Frame>() : network->frame();
    const auto now = session.received_at();
    if (frame && now < end && listener.on_frame) listener.on_frame(*frame, now);
    if (listener.on_step) listener.on_step();
    if (!*stepped || now >= shown + kSlice) {
      if (listener.on_pause) listener.on_pause();
      shown = now;
      if (listener.is_over && listener.is_over()) return {};
    }
    // A frame may have arrived long before it was taken: what is due is asked of the clock.
    if (due != kNever && session.now() >= due && session.now() < end)
      if (const auto done = listener.on_time(session.now()); !done) return done;
    if (now >= end) break;
  }
  if (listener.on_pause) listener.on_pause();
  return {};
}

}  // namespace

Result<void> listen(session::Session& session, std::optional<Duration> length, const Listener& listener) {
  const session::Stretch stretch(session, length ? session.now() + *length : kNever);
  session::BusReturn bus(session, listener.on_bus, listener.nodes);
  for (;;) {
    auto ended = listen_until(session, stretch.end(), listener);
    const bool lost = !ended && ended.error().code == Errc::bus;
    if (!lost || !listener.on_bus) return ended;
    if (auto back = bus.wait(ended.error(), stretch.end()); !back) return back;
  }
}

void tell_now(show::Desk& desk, std::string line) {
  const auto& tell = desk.session->options().tell;
  if (tell && !desk.json)
    tell(line);
  else
    desk.notices.push_back(std::move(line));
}

bool has_summary(const Result<void>& ended, std::vector<Error>& errors) {
  if (ended) return true;
  if (ended.error().code == Errc::bus) errors.push_back(ended.error());
  return ended.error().code == Errc::bus;
}

}  // namespace servoctl::traffic
