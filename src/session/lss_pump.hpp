#pragma once

#include "session/can_network.hpp"
#include "session/hearing.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// Lets a machine of LSS that was started work on the session's CAN bus until it has a result. `foreign` is
/// set where another master was heard, now or before: then Errc::refused. Else errors of the bus, and
/// Errc::interrupted.
template <class Machine>
auto pump_lss(Session& session, Machine& machine, bool& foreign)
    -> Result<typename decltype(machine.take_result())::value_type> {
  const Hearing hearing(session, [&](const can::Frame& frame, TimePoint time) {
    foreign = foreign || (frame.id == canopen::kLssRequest && !frame.extended && !frame.error);
    machine.on_frame(frame, time);
  });
  for (;;) {
    machine.on_time(session.now());
    while (const auto frame = machine.take_frame()) {
      if (const auto sent = session.can()->send(*frame); !sent) return fail(sent.error());
      machine.on_time(session.now());
    }
    if (foreign)
      return fail(Errc::refused, "another LSS master is at work on this bus",
                  "its requests and answers cannot be told from ours: end it, and begin again");
    if (auto result = machine.take_result()) return std::move(*result);
    if (const auto stepped = session.step(machine.deadline()); !stepped) return fail(stepped.error());
  }
}

}  // namespace servoctl::session
