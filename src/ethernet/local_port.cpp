#include "ethernet/local_port.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <span>

#include "base/bytes.hpp"
#include "base/format.hpp"
#include "base/signal_wait.hpp"
#include "ethernet/process.hpp"

namespace servoctl::ethernet {
namespace {

using can::Descriptor;
using can::LocalDirectory;
using can::Wake;

constexpr const char* kRing = "ring";
/// Between two looks for a ring.
constexpr Duration kPause = std::chrono::milliseconds(5);

/// What a ring says first to who comes: magic with version, then the process that is its master already
/// (little endian), zero for a welcome, -1 for one that it does not see.
using Welcome = std::array<std::uint8_t, 8>;
constexpr std::array<std::uint8_t, 4> kMagic{'S', 'V', 'E', 1};

Welcome welcome_with(::pid_t master) {
  Welcome out{};
  std::copy(kMagic.begin(), kMagic.end(), out.begin());
  store_le(static_cast<std::uint64_t>(master), std::span(out).subspan<4, 4>());
  return out;
}

Descriptor open_socket() {
  return Descriptor(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
}

std::string url_of(std::string_view name) { return formatted("coe:local:{}", name); }

::pid_t known(::pid_t process) { return process > 0 ? process : -1; }

tl::unexpected<Error> unserved(std::string_view name) {
  return fail(Errc::bus, message("nobody serves {}", url_of(name)),
              message("start `servoctl sim sv2@1 --bus {}`", as_it_is(url_of(name))));
}

tl::unexpected<Error> cannot_open(std::string_view name, int error) {
  return fail(Errc::bus, message("cannot open {}: {}", url_of(name), can::system_text(error)));
}

tl::unexpected<Error> taken(std::string_view name, ::pid_t master) {
  return fail(Errc::bus, message("{} is in use by {}", url_of(name), process_words(master)),
              "two masters on one ring would disturb each other: end the other, or wait for its end");
}

tl::unexpected<Error> silent(std::string_view name, ::pid_t ring) {
  return fail(
      Errc::bus,
      message("{} does not answer: {} serves it and is stopped, or hangs", url_of(name), process_words(ring)),
      ring > 0 ? message("resume it (`kill -CONT {0}`) or end it (`kill {0}`)", as_it_is(ring)) : "");
}

/// What a message is, in the buffer; empty: nothing is there, zero: the other end is closed.
template <std::size_t N>
std::optional<std::size_t> take_from(int socket, std::array<std::uint8_t, N>& into) {
  for (;;) {
    const auto size = ::recv(socket, into.data(), into.size(), MSG_DONTWAIT | MSG_TRUNC);
    if (size >= 0) {
      if (static_cast<std::size_t>(size) > into.size()) continue;
      return static_cast<std::size_t>(size);
    }
    if (errno == EAGAIN) return std::nullopt;
    if (errno != EINTR) return 0;
  }
}

struct Connected {
  Descriptor socket;
  ::pid_t ring = 0;
};

/// Comes to the ring, and is let in.
Result<Connected> come_to(std::string_view name, Duration patience) {
  const auto directory = LocalDirectory::open(formatted("coe:{}", name));
  if (!directory) return fail(directory.error());
  Descriptor socket = open_socket();
  if (!socket) return cannot_open(name, errno);
  const int error = directory->connect(socket.get(), kRing);
  if (error == ECONNREFUSED || error == ENOENT) return unserved(name);
  if (error == EAGAIN) return silent(name, 0);
  if (error != 0) return cannot_open(name, error);
  const auto ring = peer_process(socket.get());
  const auto limit = steady_now() + patience;
  Welcome said{};
  auto size = take_from(socket.get(), said);
  while (!size) {
    if (can::wait_for(socket.get(), POLLIN, limit) == Wake::elapsed) return silent(name, ring);
    size = take_from(socket.get(), said);
  }
  if (*size == 0) return unserved(name);
  if (*size != said.size() || !std::equal(kMagic.begin(), kMagic.end(), said.begin()))
    return fail(Errc::bus, message("{} is served by another version of servoctl", url_of(name)),
                "use the same program at both ends");
  const auto master = static_cast<::pid_t>(load_le(std::span(said).subspan<4, 4>()));
  if (master != 0) return taken(name, master);
  return Connected{std::move(socket), ring};
}

/// Whether the other end is there; a frame for which it has no room is lost.
bool give(int socket, ByteSpan frame) {
  for (;;) {
    if (::send(socket, frame.data(), frame.size(), MSG_NOSIGNAL | MSG_DONTWAIT) >= 0) return true;
    if (errno != EINTR) return errno == EAGAIN || errno == ENOBUFS;
  }
}

/// Whether the other end is closed, though what it sent before is still to be read.
bool has_left(int socket) {
  pollfd entry{socket, POLLRDHUP, 0};
  return ::poll(&entry, 1, 0) == 1 && (entry.revents & (POLLRDHUP | POLLHUP)) != 0;
}

Result<std::unique_ptr<Port>> serve_ring(std::string_view name) {
  auto directory = LocalDirectory::open(formatted("coe:{}", name));
  if (!directory) return fail(directory.error());
  Descriptor listener = open_socket();
  if (!listener) return cannot_open(name, errno);
  if (!directory->try_lock()) {
    const auto asking = open_socket();
    const bool is_known = asking && directory->connect(asking.get(), kRing) == 0;
    const auto process = is_known ? peer_process(asking.get()) : 0;
    return fail(Errc::bus, message("{} is served already, by {}", url_of(name), process_words(process)),
                "choose another name, or end it");
  }
  if (const auto bound = directory->bind(listener.get(), kRing); !bound) return fail(bound.error());
  if (::listen(listener.get(), SOMAXCONN) != 0) return cannot_open(name, errno);
  return std::make_unique<LocalRing>(std::move(*directory), std::move(listener));
}

}  // namespace

tl::unexpected<Error> LocalMaster::lost() const {
  return fail(Errc::bus, message("{} is gone: {} served it", url_of(name_), process_words(ring_)),
              message("start it again: `servoctl sim sv2@1 --bus {}`", as_it_is(url_of(name_))));
}

Result<void> LocalMaster::send(ByteSpan frame) {
  if (const auto checked = check_frame(frame); !checked) return checked;
  if (!give(socket_.get(), frame)) return lost();
  return {};
}

Result<std::optional<ByteSpan>> LocalMaster::receive(TimePoint deadline) {
  for (;;) {
    if (const auto size = take_from(socket_.get(), frame_)) {
      if (*size == 0) return lost();
      arrived_ = now();
      return std::optional(ByteSpan(frame_).first(*size));
    }
    if (now() >= deadline) return std::optional<ByteSpan>();
    if (can::wait_or_signal(socket_.get(), POLLIN, deadline) == Wake::interrupted)
      return std::optional<ByteSpan>();
  }
}

/// The ring's end of this cable is still there, though frames may not have come back.
bool LocalMaster::is_connected() const {
  ::pollfd fd{socket_.get(), 0, 0};
  return ::poll(&fd, 1, 0) == 0;
}

Result<void> LocalMaster::recover(TimePoint deadline) {
  if (is_connected()) return {};
  for (;;) {
    auto back = come_to(name_, std::min(patience_, std::max(Duration::zero(), deadline - now())));
    if (back) {
      // It takes the place of the old one, on which others may poll.
      if (::dup3(back->socket.get(), socket_.get(), O_CLOEXEC) < 0) return cannot_open(name_, errno);
      ring_ = back->ring;
      return {};
    }
    if (now() >= deadline) return fail(back.error());
    can::nap(std::min<Duration>(kPause, deadline - now()));
  }
}

LocalRing::~LocalRing() { directory_.remove(kRing); }

Result<void> LocalRing::send(ByteSpan frame) {
  if (const auto checked = check_frame(frame); !checked) return checked;
  if (master_ && !give(master_.get(), frame)) master_ = Descriptor();
  return {};
}

/// What the master has sent; when it has left there is room for the next.
std::optional<ByteSpan> LocalRing::take() {
  if (!master_) return std::nullopt;
  const auto size = take_from(master_.get(), frame_);
  if (!size) return std::nullopt;
  if (*size == 0) {
    master_ = Descriptor();
    return std::nullopt;
  }
  arrived_ = now();
  return ByteSpan(frame_).first(*size);
}

/// The first who comes is the master, the others are told so.
void LocalRing::let_in() {
  for (;;) {
    Descriptor comer(::accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!comer) return;
    // It may have left since it was read from last.
    if (master_ && has_left(master_.get())) master_ = Descriptor();
    const auto said = welcome_with(master_ ? known(peer_process(master_.get())) : 0);
    if (give(comer.get(), said) && !master_) master_ = std::move(comer);
  }
}

Result<std::optional<ByteSpan>> LocalRing::receive(TimePoint deadline) {
  for (;;) {
    if (const auto frame = take()) return frame;
    let_in();
    std::array<pollfd, 2> entries{pollfd{listener_.get(), POLLIN, 0}, pollfd{master_.get(), POLLIN, 0}};
    const auto end = deadline == kNever ? std::nullopt : std::optional(deadline);
    if (wait_or_signal_until(entries, end) <= 0) return std::optional<ByteSpan>();
  }
}

Result<std::unique_ptr<Port>> open_local_port(std::string_view name, End end, Duration patience) {
  if (const auto named = can::check_local_name(name); !named) return fail(named.error());
  if (end == End::ring) return serve_ring(name);
  auto connected = come_to(name, patience);
  if (!connected) return fail(connected.error());
  return std::make_unique<LocalMaster>(std::string(name), std::move(connected->socket), connected->ring,
                                       patience);
}

}  // namespace servoctl::ethernet
