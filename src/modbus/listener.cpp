#include "modbus/listener.hpp"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <vector>

#include "base/format.hpp"
#include "base/signal_wait.hpp"
#include "modbus/serial_port.hpp"

namespace servoctl::modbus {
namespace {

using can::Descriptor;

class SerialListener final : public Listener {
 public:
  explicit SerialListener(std::unique_ptr<Port> port) : port_(std::move(port)) {}

  Framing framing() const override { return port_->framing(); }
  Duration silence() const override { return port_->silence(); }
  Result<Arrival> receive(TimePoint deadline) override {
    auto bytes = port_->receive(deadline);
    if (!bytes) return fail(bytes.error());
    return Arrival{0, std::move(*bytes), false};
  }
  void send(int, ByteSpan bytes) override { (void)port_->send(bytes); }

 private:
  std::unique_ptr<Port> port_;
};

class TcpListener final : public Listener {
 public:
  explicit TcpListener(Descriptor fd) : fd_(std::move(fd)) {}

  Framing framing() const override { return Framing::tcp; }
  Duration silence() const override { return Duration::zero(); }
  Result<Arrival> receive(TimePoint deadline) override;
  void send(int who, ByteSpan bytes) override {
    // Who does not take a few bytes at once is not there.
    if (clients_.count(who) != 0) (void)::send(who, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  }

 private:
  void accept_one();
  Arrival read_from(int who);

  Descriptor fd_;
  std::map<int, Descriptor> clients_;  ///< By descriptor.
};

void TcpListener::accept_one() {
  constexpr std::size_t kMostClients = 16;
  Descriptor client(::accept4(fd_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!client || clients_.size() >= kMostClients) return;
  const int on = 1;
  ::setsockopt(client.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  const int who = client.get();
  clients_.insert_or_assign(who, std::move(client));
}

Listener::Arrival TcpListener::read_from(int who) {
  std::array<std::uint8_t, 1024> chunk{};
  const auto size = ::recv(who, chunk.data(), chunk.size(), MSG_DONTWAIT);
  if (size > 0) return {who, Bytes(chunk.begin(), chunk.begin() + size), false};
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return {who, {}, false};
  clients_.erase(who);
  return {who, {}, true};
}

Result<Listener::Arrival> TcpListener::receive(TimePoint deadline) {
  std::vector<pollfd> fds{{fd_.get(), POLLIN, 0}};
  for (const auto& client : clients_) fds.push_back({client.first, POLLIN, 0});
  if (servoctl::wait_or_signal_until(fds, deadline) <= 0) return Arrival{};
  if (fds.front().revents != 0) accept_one();
  for (std::size_t i = 1; i < fds.size(); ++i)
    if (fds[i].revents != 0) return read_from(fds[i].fd);
  return Arrival{};
}

}  // namespace

Result<std::unique_ptr<Listener>> listen_serial(const SerialSettings& settings) {
  auto port = open_serial(settings);
  if (!port) return fail(port.error());
  return std::make_unique<SerialListener>(std::move(*port));
}

Result<std::unique_ptr<Listener>> listen_tcp(const TcpAddress& address) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE;
  addrinfo* found = nullptr;
  const auto port = std::to_string(address.port);
  if (const int code = ::getaddrinfo(address.host.c_str(), port.c_str(), &hints, &found); code != 0)
    return fail(Errc::bus, message("{} is not found: {}", as_it_is(address.host), ::gai_strerror(code)),
                "name an address of this machine: modbus://127.0.0.1:1502");
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owned(found, &::freeaddrinfo);
  Descriptor fd(::socket(found->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int on = 1;
  if (fd) ::setsockopt(fd.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (fd && ::bind(fd.get(), found->ai_addr, found->ai_addrlen) == 0 && ::listen(fd.get(), 8) == 0)
    return std::make_unique<TcpListener>(std::move(fd));
  const int error = errno;
  const auto what = message("cannot listen at {}: ", as_it_is(address.text()));
  if (error == EACCES)
    return fail(Errc::bus, what + "ports below 1024 need the right to them",
                "use another: modbus://127.0.0.1:1502");
  if (error == EADDRINUSE) return fail(Errc::bus, what + "another program listens there", "use another port");
  if (error == EADDRNOTAVAIL)
    return fail(Errc::bus, what + "that is no address of this machine", "use modbus://127.0.0.1:1502");
  return fail(Errc::bus, what + can::system_text(error));
}

}  // namespace servoctl::modbus
