#include "ethernet/raw_port.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/if_packet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "base/format.hpp"
#include "base/signal_wait.hpp"
#include "ethernet/interface.hpp"

namespace servoctl::ethernet {
namespace {

using can::Descriptor;
using can::Wake;
using std::chrono::milliseconds;

constexpr std::uint16_t kEtherCat = 0x88A4;
/// Between two looks at an interface that is down or has no link.
constexpr Duration kReopenPause = milliseconds(5);
/// The longest wait in one call of recvfrom(): the kernel rounds it up to its ticks, of 4 ms on most
/// machines.
constexpr Duration kSlice = milliseconds(4);
/// How long send() tries while the queue of the interface is full.
constexpr Duration kSendLimit = milliseconds(20);

void set_option(int fd, int level, int option, int value) {
  ::setsockopt(fd, level, option, &value, sizeof value);
}

/// What is not there in older kernels is done without.
void configure(int fd) {
  constexpr int kReceiveBytes = 1 << 20;
  set_option(fd, SOL_PACKET, PACKET_QDISC_BYPASS, 1);
#ifdef PACKET_IGNORE_OUTGOING
  set_option(fd, SOL_PACKET, PACKET_IGNORE_OUTGOING, 1);
#endif
  set_option(fd, SOL_SOCKET, SO_RCVBUF, kReceiveBytes);
}

Result<Descriptor> packet_socket(const std::string& name, int index) {
  // No protocol yet: nothing is to come in from other interfaces.
  Descriptor socket(::socket(AF_PACKET, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!socket && (errno == EPERM || errno == EACCES)) return no_right(name);
  if (!socket && errno == EAFNOSUPPORT)
    return fail(Errc::bus, message("cannot open {}: no packet sockets in the kernel", as_it_is(name)),
                "load them with `sudo modprobe af_packet`");
  if (!socket) return interface_cannot_open(name, errno);
  configure(socket.get());
  sockaddr_ll address{};
  address.sll_family = AF_PACKET;
  address.sll_protocol = htons(kEtherCat);
  address.sll_ifindex = index;
  // The one way in which the socket interface takes addresses of all families.
  const auto* const generic = reinterpret_cast<const sockaddr*>(&address);
  if (::bind(socket.get(), generic, sizeof address) != 0) return interface_cannot_open(name, errno);
  return socket;
}

struct Opened {
  Descriptor socket;
  WireLock lock;
  int index;
};

/// By its index, so that all names of one interface are one wire.
Result<WireLock> take_lock(const std::string& name, int index) {
  return WireLock::take(formatted("interface-{}", index), name);
}

Result<Opened> open_interface(const std::string& name) {
  const auto index = interface_index(name);
  if (!index) return fail(index.error());
  auto socket = packet_socket(name, *index);
  if (!socket) return fail(socket.error());
  auto lock = take_lock(name, *index);
  if (!lock) return fail(lock.error());
  return Opened{std::move(*socket), std::move(*lock), *index};
}

/// False when there is no link until then.
bool wait_for_link(const std::string& name, TimePoint deadline) {
  while (!has_link(name)) {
    if (steady_now() >= deadline) return false;
    if (can::wait_or_signal(-1, 0, std::min(deadline, steady_now() + kReopenPause)) == Wake::interrupted)
      return false;
  }
  return true;
}

}  // namespace

RawPort::RawPort(Descriptor socket, std::optional<WireLock> lock, std::string name, End end, int index)
    : socket_(std::move(socket)),
      lock_(std::move(lock)),
      name_(std::move(name)),
      end_(end),
      index_(index),
      waits_in_slices_(can::wait_in_slices(socket_.get(), kSlice)) {}

Result<void> RawPort::send(ByteSpan frame) {
  if (const auto checked = check_frame(frame); !checked) return checked;
  std::optional<TimePoint> limit;  // The clock is asked only when the first try fails.
  for (;;) {
    if (::send(socket_.get(), frame.data(), frame.size(), MSG_NOSIGNAL | MSG_DONTWAIT) >= 0) return {};
    const int error = errno;
    if (error == EINTR) continue;
    const auto tried = now();
    if (!limit) limit = tried + kSendLimit;
    // What has no link takes nothing, and says the same as a queue that is full.
    if ((error != EAGAIN && error != ENOBUFS) || tried >= *limit || !has_link())
      return interface_lost(name_, error);
    can::nap(std::chrono::microseconds(100));
  }
}

/// While the deadline is far the kernel waits with the frames; near it poll() is precise, and no signal slips
/// by it.
Result<std::optional<ByteSpan>> RawPort::receive(TimePoint deadline) {
  for (;;) {
    const bool slice = waits_in_slices_ && deadline > now() + 2 * kSlice;
    if (slice ? signal_is_noted() : can::wait_or_signal(socket_.get(), POLLIN, deadline) != Wake::ready)
      return std::optional<ByteSpan>();
    sockaddr_ll from{};
    socklen_t from_size = sizeof from;
    const auto size =
        ::recvfrom(socket_.get(), frame_.data(), frame_.size(), MSG_TRUNC | (slice ? 0 : MSG_DONTWAIT),
                   reinterpret_cast<sockaddr*>(&from), &from_size);
    if (size < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (size <= 0) return interface_lost(name_, size < 0 ? errno : EPIPE);
    // Frames of this machine are told as outgoing; what is too long is none of EtherCAT.
    if (from.sll_pkttype == PACKET_OUTGOING || static_cast<std::size_t>(size) > frame_.size()) continue;
    arrived_ = now();
    return std::optional(ByteSpan(frame_).first(static_cast<std::size_t>(size)));
  }
}

bool RawPort::has_link() const { return ethernet::has_link(name_); }

/// An interface that was gone has another index when it is back, and so another lock; one that was only down
/// is held all the time.
Result<void> RawPort::open_again() {
  const auto index = interface_index(name_);
  if (!index) return fail(index.error());
  if (end_ == End::master && !has_link()) return no_link(name_);
  auto socket = packet_socket(name_, *index);
  if (!socket) return fail(socket.error());
  if (*index != index_) {
    auto lock = take_lock(name_, *index);
    if (!lock) return fail(lock.error());
    lock_ = std::move(*lock);
    index_ = *index;
  }
  // It takes the place of the old one, on which others may poll.
  waits_in_slices_ = can::wait_in_slices(socket->get(), kSlice);
  if (::dup3(socket->get(), socket_.get(), O_CLOEXEC) < 0) return interface_cannot_open(name_, errno);
  return {};
}

Result<void> RawPort::recover(TimePoint deadline) {
  for (;;) {
    auto opened = open_again();
    if (opened || now() >= deadline) return opened;
    can::nap(std::min<Duration>(kReopenPause, deadline - now()));
  }
}

Result<std::unique_ptr<Port>> open_raw_port(std::string_view interface_name, End end,
                                            Duration link_patience) {
  std::string name(interface_name);
  auto opened = open_interface(name);
  if (!opened) return fail(opened.error());
  if (end == End::master && !wait_for_link(name, steady_now() + link_patience)) return no_link(name);
  return std::make_unique<RawPort>(std::move(opened->socket), std::move(opened->lock), std::move(name), end,
                                   opened->index);
}

}  // namespace servoctl::ethernet
