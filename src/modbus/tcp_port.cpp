#include "modbus/tcp_port.hpp"

#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>

namespace servoctl::modbus {
namespace {

using can::Descriptor;
using can::Wake;

constexpr Duration kConnectPatience = std::chrono::seconds(3);
constexpr Duration kTcpSendPatience = std::chrono::seconds(1);
constexpr Duration kConnectPause = std::chrono::milliseconds(50);

using Found = std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)>;

Result<Found> look_up(const TcpAddress& address) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const auto port = std::to_string(address.port);
  if (const int code = ::getaddrinfo(address.host.c_str(), port.c_str(), &hints, &found); code != 0)
    return fail(Errc::bus, fmt::format("{} is not found: {}", address.host, ::gai_strerror(code)),
                "write the address of the device: modbus://192.168.0.10");
  return Found(found, &::freeaddrinfo);
}

tl::unexpected<Error> cannot_connect(const TcpAddress& address, int error) {
  const auto what = fmt::format("cannot connect to {}: ", address.text());
  switch (error) {
    case ECONNREFUSED:
      return fail(
          Errc::bus, what + "it is there, and nobody listens at this port",
          "is Modbus TCP enabled in the device, and is 502 its port? It may take one connection only");
    case ETIMEDOUT:
    case EHOSTUNREACH:
    case ENETUNREACH:
      return fail(Errc::bus, what + "no answer from there", "check power, cable and IP address: `ping` it");
    default: return fail(Errc::bus, what + can::system_text(error));
  }
}

/// 0, or what stood against it; EINTR after a signal.
int connect_until(int fd, const addrinfo& to, TimePoint deadline) {
  if (::connect(fd, to.ai_addr, to.ai_addrlen) == 0) return 0;
  if (errno != EINPROGRESS) return errno;
  const auto wake = can::wait_or_signal(fd, POLLOUT, deadline);
  if (wake == Wake::interrupted) return EINTR;
  if (wake == Wake::elapsed) return ETIMEDOUT;
  int error = 0;
  socklen_t size = sizeof error;
  ::getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size);
  return error;
}

Result<Descriptor> connect_to(const TcpAddress& address, TimePoint deadline) {
  const auto found = look_up(address);
  if (!found) return fail(found.error());
  int error = EHOSTUNREACH;
  for (const auto* to = found->get(); to != nullptr; to = to->ai_next) {
    Descriptor fd(::socket(to->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    if (!fd) continue;
    error = connect_until(fd.get(), *to, deadline);
    if (error == EINTR) return fail(Errc::interrupted, "interrupted");
    if (error != 0) continue;
    const int on = 1;
    ::setsockopt(fd.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    return fd;
  }
  return cannot_connect(address, error);
}

}  // namespace

tl::unexpected<Error> TcpPort::lost(int error) const {
  return fail(Errc::bus,
              fmt::format("{}: {}", address_.text(),
                          error == 0 ? std::string("the device closed the connection")
                                     : "the connection is lost: " + can::system_text(error)),
              "the next line connects anew");
}

Result<void> TcpPort::send(ByteSpan bytes) {
  const auto limit = now() + kTcpSendPatience;
  while (!bytes.empty()) {
    const auto sent = ::send(fd_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(sent));
      continue;
    }
    if (errno != EAGAIN && errno != EINTR) return lost(errno);
    if (now() >= limit) return lost(ETIMEDOUT);
    (void)can::wait_for(fd_.get(), POLLOUT, limit);
  }
  return {};
}

Result<Bytes> TcpPort::receive(TimePoint deadline) {
  if (can::wait_or_signal(fd_.get(), POLLIN, deadline) != Wake::ready) return Bytes();
  std::array<std::uint8_t, 1024> chunk{};
  const auto size = ::recv(fd_.get(), chunk.data(), chunk.size(), 0);
  if (size > 0) return Bytes(chunk.begin(), chunk.begin() + size);
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return Bytes();
  return lost(size < 0 ? errno : 0);
}

Result<void> TcpPort::reopen(TimePoint deadline) {
  fd_ = Descriptor();
  for (;;) {
    auto again = connect_to(address_, std::max(deadline, now() + kConnectPause));
    if (again) {
      fd_ = std::move(*again);
      return {};
    }
    if (again.error().code == Errc::interrupted || now() >= deadline) return fail(again.error());
    if (can::wait_or_signal(-1, 0, std::min(deadline, now() + kConnectPause)) == Wake::interrupted)
      return fail(again.error());
  }
}

Result<std::unique_ptr<Port>> open_tcp(const TcpAddress& address) {
  auto fd = connect_to(address, steady_now() + kConnectPatience);
  if (!fd) return fail(fd.error());
  return std::make_unique<TcpPort>(std::move(*fd), address);
}

}  // namespace servoctl::modbus
