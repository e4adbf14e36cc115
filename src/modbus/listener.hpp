#pragma once

#include <map>
#include <memory>

#include "can/descriptor.hpp"
#include "modbus/address.hpp"
#include "modbus/port.hpp"

namespace servoctl::modbus {

/// The side that is asked: who asks is known by a number.
class Listener {
 public:
  Listener() = default;
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  virtual ~Listener() = default;

  struct Arrival {
    int who = 0;
    Bytes bytes;        ///< Empty when nothing came until the deadline.
    bool gone = false;  ///< Whoever it was has closed the connection.
  };

  virtual Framing framing() const = 0;
  virtual Duration silence() const = 0;
  TimePoint now() const { return steady_now(); }
  /// Waits for bytes until `deadline`. Errc::bus when nobody can ask any more.
  virtual Result<Arrival> receive(TimePoint deadline) = 0;
  /// What cannot be delivered is dropped.
  virtual void send(int who, ByteSpan bytes) = 0;
};

/// On a serial line; its one asker is 0. Errors as open_serial().
Result<std::unique_ptr<Listener>> listen_serial(const SerialSettings& settings);
/// At an address of this machine. Errc::bus when the port is taken, or there is no right to it.
Result<std::unique_ptr<Listener>> listen_tcp(const TcpAddress& address);

}  // namespace servoctl::modbus
