#pragma once

#include <functional>
#include <optional>

#include "session/session.hpp"

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
  /// Asked after each pause: whether it is over, as after Ctrl-C.
  std::function<bool()> is_over = {};
};

/// Listens until `length` is over or Ctrl-C comes, which is no error.
Result<void> listen(session::Session& session, std::optional<Duration> length, const Listener& listener);

}  // namespace servoctl::traffic
