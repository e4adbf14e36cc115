#include "session/serve.hpp"

#include <algorithm>

#include "session/can_network.hpp"

namespace servoctl::session {
namespace {

/// Sends what the drives have to say, to the bus and to each other.
Result<void> flush(can::Bus& bus, sim::Cell& cell) {
  for (bool any = true; any;) {
    any = false;
    for (const auto& drive : cell.drives) {
      while (const auto frame = drive->take_frame()) {
        any = true;
        if (const auto sent = bus.send(*frame); !sent) return sent;
        for (const auto& other : cell.drives)
          if (other != drive) other->on_frame(*frame, bus.now());
      }
    }
  }
  return {};
}

}  // namespace

Result<void> serve(Session& session, sim::Cell& cell) {
  if (session.can() == nullptr)
    return fail(Errc::usage, "simulated drives need a CAN bus", "name one: --bus can0 or local:NAME");
  auto& bus = session.can()->bus();
  const auto& cancelled = session.options().cancelled;
  for (;;) {
    TimePoint next = bus.now() + std::chrono::hours(1);
    for (const auto& drive : cell.drives) {
      if (drive->deadline() <= bus.now()) drive->on_time(bus.now());
      next = std::min(next, drive->deadline());
    }
    if (const auto sent = flush(bus, cell); !sent) return sent;
    if (cancelled && cancelled()) return {};
    const auto frame = bus.receive(next);
    if (!frame) return fail(frame.error());
    if (!*frame || (*frame)->error) continue;
    for (const auto& drive : cell.drives) drive->on_frame(**frame, bus.now());
  }
}

}  // namespace servoctl::session
