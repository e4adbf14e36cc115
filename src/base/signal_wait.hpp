#pragma once

#include <poll.h>

#include <optional>
#include <span>

#include "base/time.hpp"

namespace servoctl {

/// For the handlers of signals: the next wait_or_signal() ends at once. Async-signal-safe.
void note_signal();
/// How many were noted so far.
unsigned signals_noted();

/// Whether one was noted since a wait last ended by a signal; the question counts as such an end. For waits
/// in which a signal may come a little too early to end them.
bool signal_is_noted();

/// ppoll() by which no signal slips: one that was noted since a wait last ended by a signal, before this call
/// or in it, ends it with -1 and EINTR. So who tests what a handler sets, and then waits here, never waits in
/// vain. Other signals do not end it. `longest`: empty for ever, else not negative. The answer is that of
/// ppoll().
int wait_or_signal(std::span<pollfd> descriptors, std::optional<Duration> longest);
/// The same until a time of steady_now(); asks the clock once, which is a system call on some machines.
int wait_or_signal_until(std::span<pollfd> descriptors, std::optional<TimePoint> deadline);

}  // namespace servoctl
