#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "base/time.hpp"
#include "can/frame.hpp"

namespace servoctl::can {

/// A CAN bus and the clock that belongs to it: real transports use the steady clock, a simulated bus its own,
/// so that no test ever sleeps.
class Bus {
 public:
  Bus() = default;
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;
  virtual ~Bus() = default;

  virtual TimePoint now() const = 0;

  /// Hands one frame to the bus. Waits while the transmit queue is full, at most a second; Errc::bus when the
  /// interface is down or gone.
  virtual Result<void> send(const Frame& frame) = 0;

  /// Waits for a frame until `deadline`; one in the past asks without waiting. An empty optional means that
  /// there was none; it may come before the deadline when a signal woke the process up.
  virtual Result<std::optional<Frame>> receive(TimePoint deadline) = 0;

  /// After Errc::bus: waits until `deadline` at most for the interface, and takes part again when it is back;
  /// one that was gone is opened anew. Errc::bus while it is not back; at once where it never comes.
  virtual Result<void> recover(TimePoint /*deadline*/) {
    return fail(Errc::bus, "this bus does not come back by itself");
  }

  /// Where the bitrate is set by who opens the bus: leaves it, and takes part again at this one with the next
  /// recover(). Errc::usage where it is not.
  virtual Result<void> leave_for(std::uint32_t /*bitrate*/) {
    return fail(Errc::usage, "the bitrate of this bus is not set where it is opened");
  }

  /// What an adapter says of itself, for people; empty where there is nothing to say.
  virtual std::string about() const { return {}; }

  /// When the frame that receive() gave last arrived, on the clock of now(); where the kernel stamps frames,
  /// it does not matter how late receive() was called.
  virtual TimePoint arrived() const { return now(); }

  /// From now on frames may be handed on so much late, many at a time: saves waking up for each of them where
  /// nobody is to answer. Zero, as at the beginning: every frame at once.
  virtual void gather(Duration /*delay*/) {}

  /// Whatever is kept back for a file is written to it now; see trace_to().
  virtual void flush_trace() {}

  /// A descriptor that becomes readable when receive() has something to give, for use in a poll loop; -1 if
  /// none.
  virtual int poll_fd() const { return -1; }

  /// What people should know of the bus beside its frames, since the last call.
  virtual std::vector<Message> take_notices() { return {}; }

  /// How many CAN FD frames have come since it was opened: receive() does not give them. 0 where there are
  /// none.
  virtual std::uint64_t fd_frames() const { return 0; }

  /// When the bus wants receive() called although its descriptor is not readable: something is due or kept
  /// inside; kNever when there is nothing such.
  virtual TimePoint next_event() const { return kNever; }

  /// The last call: whoever writes a trace leaves the bus, then brings what is left to the file and tells
  /// what could not be written. A destructor tells nobody.
  virtual void end_trace() {}
};

}  // namespace servoctl::can
