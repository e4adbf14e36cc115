#pragma once

#include <memory>
#include <string>
#include <vector>

#include "can/descriptor.hpp"
#include "modbus/address.hpp"
#include "modbus/port.hpp"

namespace servoctl::modbus {

/// A serial line: an adapter, a port of the machine, or one end of a pseudo-terminal.
class SerialPort final : public Port {
 public:
  SerialPort(can::Descriptor fd, SerialSettings settings)
      : fd_(std::move(fd)), settings_(std::move(settings)) {}

  Framing framing() const override { return settings_.framing; }
  Duration silence() const override;
  TimePoint now() const override { return steady_now(); }
  Result<void> send(ByteSpan bytes) override;
  Result<Bytes> receive(TimePoint deadline) override;
  Result<void> reopen(TimePoint deadline) override;
  int poll_fd() const override { return fd_.get(); }

 private:
  tl::unexpected<Error> lost(int error) const;

  can::Descriptor fd_;
  SerialSettings settings_;
};

/// Opens and sets the line, for this process alone. Errc::bus with what mends it: no such port, no right, in
/// use, a speed that it does not have.
Result<std::unique_ptr<Port>> open_serial(const SerialSettings& settings);

/// The serial ports of this machine that adapters have: `/dev/ttyUSB0`.
std::vector<std::string> serial_adapters();

}  // namespace servoctl::modbus
