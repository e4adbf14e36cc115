#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "can/tcp_client.hpp"
#include "modbus/address.hpp"
#include "modbus/port.hpp"

namespace servoctl::modbus {

/// A connection to a device, or to a gateway with a serial line behind it.
class TcpPort final : public Port {
 public:
  TcpPort(can::TcpClient connection, TcpAddress address)
      : connection_(std::move(connection)), address_(std::move(address)) {}

  Framing framing() const override { return Framing::tcp; }
  Duration silence() const override { return Duration::zero(); }
  TimePoint now() const override { return steady_now(); }
  Result<void> send(ByteSpan bytes) override;
  Result<Bytes> receive(TimePoint deadline) override;
  Result<void> reopen(TimePoint deadline) override;
  int poll_fd() const override { return connection_ ? connection_->get() : -1; }

 private:
  tl::unexpected<Error> not_connected() const;

  std::optional<can::TcpClient> connection_;  ///< Empty after a reopen() that failed.
  TcpAddress address_;
};

/// Connects, for three seconds at most; a signal ends the wait. Errors as can::TcpClient::connect().
Result<std::unique_ptr<Port>> open_tcp(const TcpAddress& address);

}  // namespace servoctl::modbus
