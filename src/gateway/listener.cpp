#include "gateway/listener.hpp"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "base/format.hpp"

namespace servoctl::gateway {
namespace {

using can::Descriptor;

constexpr int kQueue = 8;

tl::unexpected<Error> cannot_listen(const Address& address, int error) {
  const auto what = message("cannot listen at {}: ", as_it_is(address.text()));
  if (error == EACCES)
    return fail(Errc::bus, what + "there is no right to it",
                "use another port, or a path in a folder of yours");
  struct stat file {};
  if (error == EADDRINUSE && !address.path.empty() && ::stat(address.path.c_str(), &file) == 0 &&
      !S_ISSOCK(file.st_mode))
    return fail(Errc::bus, what + "that is a file or a folder, and no socket",
                "use a name that is not there yet");
  if (error == EADDRINUSE) return fail(Errc::bus, what + "another program listens there", "use another one");
  if (error == EADDRNOTAVAIL)
    return fail(Errc::bus, what + "that is no address of this machine", "use 127.0.0.1:60000");
  return fail(Errc::bus, what + can::system_text(error));
}

sockaddr_un path_address(const std::string& path) {
  sockaddr_un out{};
  out.sun_family = AF_UNIX;
  std::memcpy(out.sun_path, path.c_str(), path.size() + 1);  // parse_place() sees to its length.
  return out;
}

/// Whether the file is a socket that nobody listens at: left behind by a program that was killed.
bool is_left_behind(const sockaddr_un& at) {
  struct stat file {};
  if (::stat(at.sun_path, &file) != 0 || !S_ISSOCK(file.st_mode)) return false;
  const Descriptor trial(::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  return ::connect(trial.get(), reinterpret_cast<const sockaddr*>(&at), sizeof at) != 0 &&
         errno == ECONNREFUSED;
}

Result<std::unique_ptr<Listener>> listen_at_path(const Address& address) {
  const auto at = path_address(address.path);
  Descriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (is_left_behind(at)) ::unlink(at.sun_path);
  if (::bind(socket.get(), reinterpret_cast<const sockaddr*>(&at), sizeof at) != 0)
    return cannot_listen(address, errno);
  auto out = std::make_unique<Listener>(std::move(socket), address.path);
  if (!out->start()) return cannot_listen(address, errno);
  return out;
}

Result<std::unique_ptr<Listener>> listen_at_port(const Address& address) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (const int code =
          ::getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &hints, &found);
      code != 0)
    return fail(Errc::bus, message("{} is not found: {}", as_it_is(address.host), ::gai_strerror(code)),
                "name an address of this machine: 127.0.0.1:60000");
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owned(found, &::freeaddrinfo);
  Descriptor socket(::socket(found->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int on = 1;
  ::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (::bind(socket.get(), found->ai_addr, found->ai_addrlen) != 0) return cannot_listen(address, errno);
  auto out = std::make_unique<Listener>(std::move(socket), std::string());
  if (!out->start()) return cannot_listen(address, errno);
  return out;
}

/// A client whose cable is pulled is gone after five seconds: what it energised must not stay so.
void configure(int client) {
  const auto set = [client](int level, int option, int value) {
    (void)::setsockopt(client, level, option, &value, sizeof value);
  };
  set(IPPROTO_TCP, TCP_NODELAY, 1);
  set(SOL_SOCKET, SO_KEEPALIVE, 1);
  set(IPPROTO_TCP, TCP_KEEPIDLE, 2);
  set(IPPROTO_TCP, TCP_KEEPINTVL, 1);
  set(IPPROTO_TCP, TCP_KEEPCNT, 3);
  set(IPPROTO_TCP, TCP_USER_TIMEOUT, 5'000);
}

}  // namespace

Result<std::unique_ptr<Listener>> Listener::open(const Address& address) {
  return address.is_path() ? listen_at_path(address) : listen_at_port(address);
}

bool Listener::start() { return ::listen(socket_.get(), kQueue) == 0; }

Listener::~Listener() {
  if (!path_.empty()) ::unlink(path_.c_str());
}

std::vector<pollfd> Listener::interests(const std::function<short(int)>& events) const {
  std::vector<pollfd> out{{socket_.get(), POLLIN, 0}};
  for (const auto& [who, client] : clients_) out.push_back({client.get(), events(who), 0});
  return out;
}

void Listener::accept_one(std::vector<Arrival>& out) {
  Descriptor client(::accept4(socket_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!client || clients_.size() > kMostClients) return;
  configure(client.get());
  out.push_back({.who = ++last_, .bytes = {}, .came = true});
  clients_.emplace(last_, std::move(client));
}

Listener::Arrival Listener::read_from(int who, const Descriptor& client, short happened) const {
  Arrival out{.who = who, .bytes = {}};
  if ((happened & POLLIN) == 0) {
    out.lost = (happened & (POLLERR | POLLHUP | POLLNVAL)) != 0;
    return out;
  }
  std::array<char, 4096> chunk{};
  const auto size = ::recv(client.get(), chunk.data(), chunk.size(), MSG_DONTWAIT);
  if (size > 0) out.bytes.assign(chunk.data(), static_cast<std::size_t>(size));
  out.ended = size == 0;
  out.lost = size < 0 && errno != EAGAIN && errno != EINTR;
  return out;
}

std::vector<Listener::Arrival> Listener::take(std::span<const pollfd> polled) {
  std::vector<Arrival> out;
  std::size_t at = 1;
  for (const auto& [who, client] : clients_) {
    if (at >= polled.size()) break;
    if (const auto happened = polled[at++].revents; happened != 0)
      out.push_back(read_from(who, client, happened));
  }
  if (!polled.empty() && polled.front().revents != 0) accept_one(out);
  return out;
}

bool Listener::send(int who, std::string& text) {
  const auto client = clients_.find(who);
  if (client == clients_.end()) return false;
  while (!text.empty()) {
    const auto sent = ::send(client->second.get(), text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) return errno == EAGAIN;
    text.erase(0, static_cast<std::size_t>(sent));
  }
  return true;
}

}  // namespace servoctl::gateway
