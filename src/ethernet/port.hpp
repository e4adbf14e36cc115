#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/bytes.hpp"
#include "base/result.hpp"
#include "base/time.hpp"

namespace servoctl::ethernet {

/// One Ethernet wire with an EtherCAT ring on it, and the clock that belongs to it. Carries whole frames,
/// from the destination address on, without the checksum; knows nothing of what is in them but the type
/// 88A4h.
class Port {
 public:
  Port() = default;
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;
  virtual ~Port() = default;

  /// Monotonic; in tests it may be virtual.
  virtual TimePoint now() const = 0;

  /// Sends a frame of 60 to 1514 bytes; it is copied. Errc::bus when the wire does not take it: the interface
  /// is gone or down.
  virtual Result<void> send(ByteSpan frame) = 0;
  /// Waits until `deadline` at most for a frame that came from the wire: what this port sent itself is none.
  /// The view is valid until the next call. Empty when the deadline passes, or a signal came. Errc::bus as
  /// send().
  virtual Result<std::optional<ByteSpan>> receive(TimePoint deadline) = 0;
  /// When the frame of the last receive() arrived.
  virtual TimePoint arrived() const { return now(); }
  /// When receive() has something to do although nothing comes from outside; kNever when it has not.
  virtual TimePoint next_event() const { return kNever; }
  /// A descriptor that becomes readable when receive() has something to give, for a poll loop; -1: none.
  virtual int poll_fd() const { return -1; }
  /// After Errc::bus: waits until `deadline` at most for the wire to come back. Errc::bus while it is not
  /// back; at once where it never comes.
  virtual Result<void> recover(TimePoint deadline) = 0;

  /// Whether a cable is plugged in, with somebody at its other end; true where that cannot be known.
  virtual bool has_link() const { return true; }
  /// What people should know of the wire, a line each, since the last call.
  virtual std::vector<Message> take_notices() { return {}; }
  /// Whatever is kept back for a file is written to it now.
  virtual void flush_trace() {}
  /// As can::Bus::end_trace().
  virtual void end_trace() {}
};

}  // namespace servoctl::ethernet
