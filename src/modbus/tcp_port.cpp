#include "modbus/tcp_port.hpp"

#include <poll.h>

#include <algorithm>
#include <string>

#include "base/format.hpp"

namespace servoctl::modbus {
namespace {

using can::Wake;

constexpr Duration kConnectPatience = std::chrono::seconds(3);
constexpr Duration kTcpSendPatience = std::chrono::seconds(1);
constexpr Duration kConnectPause = std::chrono::milliseconds(50);

Result<can::TcpClient> connect_to(const TcpAddress& address, TimePoint limit) {
  return can::TcpClient::connect(
      {address.host, address.port, address.text(),
       "is Modbus TCP enabled in the device, and is 502 its port? It may take one connection only",
       "it may take one connection only; the next line connects anew"},
      limit, true);
}

}  // namespace

tl::unexpected<Error> TcpPort::not_connected() const {
  return fail(Errc::bus, message("the connection to {} is lost", address_.text()),
              "the next line connects anew");
}

Result<void> TcpPort::send(ByteSpan bytes) {
  if (!connection_) return not_connected();
  return connection_->send(as_text(bytes), now() + kTcpSendPatience);
}

Result<Bytes> TcpPort::receive(TimePoint deadline) {
  if (!connection_) return not_connected();
  if (can::wait_or_signal(connection_->get(), POLLIN, deadline) != Wake::ready) return Bytes();
  std::string text;
  const auto got = connection_->receive(text);
  if (!got && text.empty()) return fail(got.error());
  return Bytes(text.begin(), text.end());
}

Result<void> TcpPort::reopen(TimePoint deadline) {
  connection_.reset();
  for (;;) {
    auto again = connect_to(address_, std::max(deadline, now() + kConnectPause));
    if (again) {
      connection_.emplace(std::move(*again));
      return {};
    }
    if (again.error().code == Errc::interrupted || now() >= deadline) return fail(again.error());
    if (can::wait_or_signal(-1, 0, std::min(deadline, now() + kConnectPause)) == Wake::interrupted)
      return fail(again.error());
  }
}

Result<std::unique_ptr<Port>> open_tcp(const TcpAddress& address) {
  auto connection = connect_to(address, steady_now() + kConnectPatience);
  if (!connection) return fail(connection.error());
  return std::make_unique<TcpPort>(std::move(*connection), address);
}

}  // namespace servoctl::modbus
