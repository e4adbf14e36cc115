#include "ethernet/wire_lock.hpp"

#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <iterator>

#include "base/format.hpp"
#include "ethernet/process.hpp"

namespace servoctl::ethernet {
namespace {

using can::Descriptor;

/// An address in the abstract namespace: no file stands for it.
struct Address {
  explicit Address(const std::string& key) {
    const auto name = "servoctl/wire/" + key;
    raw.sun_family = AF_UNIX;
    const auto length = std::min(name.size(), sizeof raw.sun_path - 1);
    std::copy_n(name.begin(), length, std::begin(raw.sun_path) + 1);
    size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + length);
  }
  /// The one way in which the socket interface takes addresses of all families.
  const sockaddr* generic() const { return reinterpret_cast<const sockaddr*>(&raw); }

  sockaddr_un raw{};
  socklen_t size = 0;
};

Descriptor lock_socket() {
  return Descriptor(::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
}

/// Who listens there tells its process by that alone; nobody accepts.
::pid_t holder(const Address& address) {
  const auto socket = lock_socket();
  if (!socket || ::connect(socket.get(), address.generic(), address.size) != 0) return 0;
  return peer_process(socket.get());
}

tl::unexpected<Error> held(const Address& address, const std::string& shown) {
  const auto process = holder(address);
  auto hint =
      std::string("two programs on one wire would disturb each other: end the other, or wait for its end");
  if (process > 0) hint += formatted("; `ps -fp {}` shows it", process);
  return fail(Errc::bus, message("{} is in use by {}", shown, process_words(process)), std::move(hint));
}

}  // namespace

Result<WireLock> WireLock::take(const std::string& key, const std::string& shown) {
  const Address address(key);
  auto socket = lock_socket();
  if (!socket) return fail(Errc::bus, message("cannot lock {}: {}", shown, can::system_text(errno)));
  if (::bind(socket.get(), address.generic(), address.size) != 0) {
    if (errno == EADDRINUSE) return held(address, shown);
    return fail(Errc::bus, message("cannot lock {}: {}", shown, can::system_text(errno)));
  }
  // Those who ask stay in its queue: it has room for all.
  ::listen(socket.get(), SOMAXCONN);
  return WireLock(std::move(socket));
}

}  // namespace servoctl::ethernet
