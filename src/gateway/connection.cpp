#include "gateway/connection.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <cerrno>
#include <cstring>

#include "base/format.hpp"

namespace servoctl::gateway {
namespace {

constexpr std::string_view kStartOne =
    "is a gateway started there? canopend can0 -i 1 -c tcp-60000 is one, servoctl's own is `gateway`";

tl::unexpected<Error> lost(const std::string& place, int error) {
  return fail(Errc::bus,
              error == 0
                  ? message("{} closed the connection", as_it_is(place))
                  : message("the connection to {} is lost: {}", as_it_is(place), can::system_text(error)),
              "did the gateway end? Its own log says");
}

}  // namespace

Result<Connection> Connection::open_path(const Address& address) {
  Connection out(address.text());
  out.local_ = can::Descriptor(::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  sockaddr_un at{};
  at.sun_family = AF_UNIX;
  std::memcpy(at.sun_path, address.path.c_str(), address.path.size() + 1);  // parse_url() sees to its length.
  if (::connect(out.get(), reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0) return out;
  if (errno == ECONNREFUSED || errno == ENOENT)
    return fail(Errc::bus, message("nothing listens at {}", as_it_is(address.path)), std::string(kStartOne));
  return fail(Errc::bus, message("cannot reach {}: {}", as_it_is(address.path), can::system_text(errno)));
}

Result<Connection> Connection::open(const Address& address, TimePoint limit, bool ends_by_signal) {
  if (address.is_path()) return open_path(address);
  auto tcp = can::TcpClient::connect({address.host, address.port, address.text(), std::string(kStartOne),
                                      "did the gateway end? Its own log says"},
                                     limit, ends_by_signal);
  if (!tcp) return fail(tcp.error());
  Connection out(address.text());
  out.tcp_ = std::move(*tcp);
  return out;
}

Result<void> Connection::send(std::string_view text, TimePoint limit) {
  if (tcp_) return tcp_->send(text, limit);
  while (!text.empty()) {
    const auto sent = ::send(get(), text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent >= 0) {
      text.remove_prefix(static_cast<std::size_t>(sent));
      continue;
    }
    if (errno == EINTR) continue;
    if (errno != EAGAIN) return lost(place_, errno);
    if (steady_now() >= limit) return lost(place_, ETIMEDOUT);
    can::wait_for(get(), POLLOUT, limit);
  }
  return {};
}

Result<void> Connection::receive(std::string& out) {
  if (tcp_) return tcp_->receive(out);
  if (const auto taken = can::take_in(get(), out); !taken.there) return lost(place_, taken.error);
  return {};
}

void Connection::send_now(std::string_view text) const noexcept {
  (void)::send(get(), text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

}  // namespace servoctl::gateway
