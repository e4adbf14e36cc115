#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "can/serial_port.hpp"
#include "modbus/address.hpp"
#include "modbus/port.hpp"

namespace servoctl::modbus {

/// A serial line: an adapter, a port of the machine, or one end of a pseudo-terminal.
class SerialPort final : public Port {
 public:
  SerialPort(can::SerialPort port, SerialSettings settings)
      : port_(std::move(port)), settings_(std::move(settings)) {}

  Framing framing() const override { return settings_.framing; }
  Duration silence() const override;
  TimePoint now() const override { return steady_now(); }
  Result<void> send(ByteSpan bytes) override;
  Result<Bytes> receive(TimePoint deadline) override;
  Result<void> reopen(TimePoint deadline) override;
  int poll_fd() const override { return port_ ? port_->get() : -1; }

 private:
  tl::unexpected<Error> not_open() const;

  std::optional<can::SerialPort> port_;  ///< Empty after a reopen() that failed.
  SerialSettings settings_;
};

/// Opens and sets the line, for this process alone. Errors as can::SerialPort::open().
Result<std::unique_ptr<Port>> open_serial(const SerialSettings& settings);

}  // namespace servoctl::modbus
