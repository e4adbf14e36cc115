#pragma once

#include <memory>

#include "can/descriptor.hpp"
#include "modbus/address.hpp"
#include "modbus/port.hpp"

namespace servoctl::modbus {

/// A connection to a device, or to a gateway with a serial line behind it.
class TcpPort final : public Port {
 public:
  TcpPort(can::Descriptor fd, TcpAddress address) : fd_(std::move(fd)), address_(std::move(address)) {}

  Framing framing() const override { return Framing::tcp; }
  Duration silence() const override { return Duration::zero(); }
  TimePoint now() const override { return steady_now(); }
  Result<void> send(ByteSpan bytes) override;
  Result<Bytes> receive(TimePoint deadline) override;
  Result<void> reopen(TimePoint deadline) override;
  int poll_fd() const override { return fd_.get(); }

 private:
  tl::unexpected<Error> lost(int error) const;

  can::Descriptor fd_;
  TcpAddress address_;
};

/// Connects, for three seconds at most; a signal ends the wait. Errc::bus with what may be the cause.
Result<std::unique_ptr<Port>> open_tcp(const TcpAddress& address);

}  // namespace servoctl::modbus
