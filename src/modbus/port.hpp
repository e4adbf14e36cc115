#pragma once

#include "base/bytes.hpp"
#include "base/result.hpp"
#include "base/time.hpp"
#include "modbus/framing.hpp"

namespace servoctl::modbus {

/// What carries bytes to units and back, and the clock that belongs to it: a serial line, a connection, or a
/// simulated one with a clock of its own.
class Port {
 public:
  Port() = default;
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;
  virtual ~Port() = default;

  virtual Framing framing() const = 0;
  /// The silence between messages that its speed asks for: 3.5 characters, or 1.75 ms above 19200 bit/s
  /// (MODBUS over Serial Line V1.02, 2.5.1.1); zero where messages are told apart otherwise.
  virtual Duration silence() const = 0;
  virtual TimePoint now() const = 0;
  /// Errc::bus when the line is gone.
  virtual Result<void> send(ByteSpan bytes) = 0;
  /// Waits for bytes until `deadline`; empty when none came, which may be earlier when a signal woke the
  /// process up. Errc::bus when the line is gone.
  virtual Result<Bytes> receive(TimePoint deadline) = 0;
  /// After Errc::bus, and for a stream that is out of step: opens it anew, and tries until `deadline` at
  /// most.
  virtual Result<void> reopen(TimePoint deadline) = 0;
  /// For a poll loop; -1 when there is none.
  virtual int poll_fd() const { return -1; }
  /// When receive() has something to give although no descriptor tells; kNever when it has not.
  virtual TimePoint next_event() const { return kNever; }
};

}  // namespace servoctl::modbus
