#include "can/tcp_client.hpp"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include <cerrno>
#include <memory>
#include <optional>
#include <thread>

#include "base/format.hpp"

namespace servoctl::can {
namespace {

/// The kernel gives a connection up after so long without an acknowledge.
constexpr int kSilenceMs = 5'000;

struct FreeAddresses {
  void operator()(addrinfo* list) const { ::freeaddrinfo(list); }
};
using Addresses = std::unique_ptr<addrinfo, FreeAddresses>;

Wake await_in_spite_of_signals(int descriptor, TimePoint limit) {
  for (;;)
    if (const auto woken = wait_for(descriptor, POLLIN, limit); woken != Wake::interrupted) return woken;
}

/// A thread that is begun meanwhile takes no signals: they are for who waits.
class SignalsBlocked {
 public:
  SignalsBlocked() {
    sigset_t all;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  SignalsBlocked(const SignalsBlocked&) = delete;
  SignalsBlocked& operator=(const SignalsBlocked&) = delete;
  ~SignalsBlocked() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

 private:
  sigset_t before_{};
};

/// A name that is looked up; a thread of its own, because nobody can end the system's search.
struct Lookup {
  TcpServer server;
  Addresses list;
  int error = 0;
  int system_error = 0;
  Descriptor done;
};

void look_up(Lookup& to, int flags) {
  addrinfo wanted{};
  wanted.ai_family = AF_UNSPEC;
  wanted.ai_socktype = SOCK_STREAM;
  wanted.ai_flags = AI_NUMERICSERV | flags;
  addrinfo* list = nullptr;
  to.error = ::getaddrinfo(to.server.host.c_str(), std::to_string(to.server.port).c_str(), &wanted, &list);
  to.system_error = errno;
  if (to.error == 0) to.list.reset(list);
}

tl::unexpected<Error> host_not_found(const Lookup& lookup) {
  return fail(Errc::bus,
              message("the host {} is not found: {}", as_it_is(lookup.server.host),
                      lookup.error == EAI_SYSTEM ? system_text(lookup.system_error)
                                                 : std::string(::gai_strerror(lookup.error))),
              "check its name, or write its address");
}

Result<Addresses> addresses_of(const TcpServer& server, TimePoint limit, bool ends_by_signal) {
  const auto lookup = std::make_shared<Lookup>();
  lookup->server = server;
  look_up(*lookup, AI_NUMERICHOST);
  if (lookup->error == 0) return std::move(lookup->list);
  lookup->done = Descriptor(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  try {
    const SignalsBlocked none;
    std::thread([lookup] {
      look_up(*lookup, 0);
      (void)::eventfd_write(lookup->done.get(), 1);
    }).detach();
  } catch (...) {
    return fail(Errc::bus, message("the host {} cannot be looked up", as_it_is(server.host)),
                "write its address");
  }
  const auto woken = ends_by_signal ? wait_or_signal(lookup->done.get(), POLLIN, limit)
                                    : await_in_spite_of_signals(lookup->done.get(), limit);
  if (woken == Wake::interrupted) return fail(Errc::interrupted, "interrupted");
  if (woken == Wake::elapsed)
    return fail(Errc::bus, message("the host {} is not found in time", as_it_is(server.host)),
                "does the name server answer? `getent hosts NAME` asks it; or write the host's address");
  if (lookup->error != 0) return host_not_found(*lookup);
  return std::move(lookup->list);
}

void set_tcp_option(int socket, int level, int option, int value) {
  (void)::setsockopt(socket, level, option, &value, sizeof value);
}

void configure_connection(int socket) {
  set_tcp_option(socket, IPPROTO_TCP, TCP_NODELAY, 1);
  set_tcp_option(socket, SOL_SOCKET, SO_KEEPALIVE, 1);
  set_tcp_option(socket, IPPROTO_TCP, TCP_KEEPIDLE, 2);
  set_tcp_option(socket, IPPROTO_TCP, TCP_KEEPINTVL, 1);
  set_tcp_option(socket, IPPROTO_TCP, TCP_KEEPCNT, 3);
  set_tcp_option(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, kSilenceMs);
}

/// What became of a connection that was begun: 0 when it stands, else the error; ETIMEDOUT at the limit,
/// EINTR by a signal.
int await_connection(int socket, TimePoint limit, bool ends_by_signal) {
  for (;;) {
    const auto woken =
        ends_by_signal ? wait_or_signal(socket, POLLOUT, limit) : wait_for(socket, POLLOUT, limit);
    if (woken == Wake::interrupted && ends_by_signal) return EINTR;
    if (woken == Wake::elapsed) return ETIMEDOUT;
    if (woken == Wake::interrupted) continue;
    int error = 0;
    socklen_t size = sizeof error;
    return ::getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size) == 0 ? error : errno;
  }
}

int try_address(const addrinfo& address, Descriptor& out, TimePoint limit, bool ends_by_signal) {
  Descriptor socket(::socket(address.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!socket) return errno;
  configure_connection(socket.get());
  if (::connect(socket.get(), address.ai_addr, address.ai_addrlen) != 0) {
    if (errno != EINPROGRESS) return errno;
    if (const int error = await_connection(socket.get(), limit, ends_by_signal); error != 0) return error;
  }
  out = std::move(socket);
  return 0;
}

tl::unexpected<Error> not_connected(const TcpServer& server, int error) {
  if (error == EINTR) return fail(Errc::interrupted, "interrupted");
  if (error == ECONNREFUSED)
    return fail(Errc::bus, message("nothing listens at {}", as_it_is(server.name)), server.absent);
  if (error == ETIMEDOUT)
    return fail(Errc::bus, message("{} does not answer", as_it_is(server.name)),
                "is it switched on, in this network, and does a firewall let this port through?");
  return fail(Errc::bus, message("cannot reach {}: {}", as_it_is(server.name), system_text(error)),
              "check the network: `ip route get ADDRESS`");
}

}  // namespace

Result<TcpClient> TcpClient::connect(const TcpServer& server, TimePoint limit, bool ends_by_signal) {
  const auto addresses = addresses_of(server, limit, ends_by_signal);
  if (!addresses) return fail(addresses.error());
  int error = EADDRNOTAVAIL;
  for (const auto* at = addresses->get(); at != nullptr; at = at->ai_next) {
    Descriptor socket;
    error = try_address(*at, socket, limit, ends_by_signal);
    if (error == 0) return TcpClient(std::move(socket), server);
    if (error == EINTR || steady_now() >= limit) break;
  }
  return not_connected(server, error);
}

tl::unexpected<Error> TcpClient::lost(int error) const {
  if (error == 0)
    return fail(Errc::bus, message("{} closed the connection", as_it_is(server_.name)), server_.closed);
  return fail(Errc::bus,
              message("the connection to {} is lost: {}", as_it_is(server_.name), system_text(error)),
              "check cable and network");
}

Result<void> TcpClient::send(std::string_view text, TimePoint limit) {
  while (!text.empty()) {
    const auto sent = ::send(socket_.get(), text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent >= 0) {
      text.remove_prefix(static_cast<std::size_t>(sent));
      continue;
    }
    if (errno == EINTR) continue;
    if (errno != EAGAIN) return lost(errno);
    if (steady_now() >= limit) return lost(ETIMEDOUT);
    wait_for(socket_.get(), POLLOUT, limit);
  }
  return {};
}

void TcpClient::abandon() {
  const linger none{1, 0};
  (void)::setsockopt(socket_.get(), SOL_SOCKET, SO_LINGER, &none, sizeof none);
}

Result<void> TcpClient::receive(std::string& out) {
  if (const auto taken = take_in(socket_.get(), out); !taken.there) return lost(taken.error);
  return {};
}

}  // namespace servoctl::can
