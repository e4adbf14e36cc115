#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "session/bus_return.hpp"
#include "show/desk.hpp"

/// What commands that listen to the bus have in common.
namespace servoctl::traffic {

/// What is done while listening; any of them may be empty.
struct Listener {
  /// Told each frame of a CAN bus; on another network there are none.
  std::function<void(const can::Frame& frame, TimePoint time)> on_frame = {};
  /// Called after each step, for what comes in no frame of its own: process data of a ring.
  std::function<void()> on_step = {};
  /// Called whenever nothing more is waiting, and every 50 ms.
  std::function<void()> on_pause = {};
  /// Called when `next` (asked each time) has come.
  std::function<Result<void>(TimePoint now)> on_time = {};
  std::function<TimePoint()> next = {};
  /// Where it is set a lost bus is waited for (session::BusReturn), until `length` is over, and this is told.
  session::BusReturn::Tell on_bus = {};
  /// Have to be the same drives then, where it is known who they were.
  std::vector<std::uint8_t> nodes = {};
  /// Asked after each pause: whether it is over, as after Ctrl-C.
  std::function<bool()> is_over = {};
};

/// Listens until `length` is over or Ctrl-C comes, which is no error. Errc::bus when the bus is lost and is
/// not waited for, or did not come back; else as BusReturn::wait(). Whoever has something to show behind such
/// an end shows it beside the error: has_summary().
Result<void> listen(session::Session& session, std::optional<Duration> length, const Listener& listener);

/// Shows a line while the command goes on; with `--json` it becomes a notice of the result.
void tell_now(show::Desk& desk, std::string line);

/// Whether a summary of what came before is shown all the same; an error of the bus is put beside it.
bool has_summary(const Result<void>& ended, std::vector<Error>& errors);

}  // namespace servoctl::traffic
