#include "can/local.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/bytes.hpp"
#include "base/format.hpp"

namespace servoctl::can {
namespace {

/// A datagram: magic with version, flags, size, two bytes that are zero, identifier (little endian), data.
using Datagram = std::array<std::uint8_t, 20>;

constexpr std::array<std::uint8_t, 4> kMagic{'S', 'V', 'C', 1};
constexpr std::size_t kFlagsAt = 4;
constexpr std::size_t kSizeAt = 5;
constexpr std::size_t kIdAt = 8;
constexpr std::size_t kDataAt = 12;
constexpr unsigned kExtended = 1;
constexpr unsigned kRemote = 2;
constexpr unsigned kError = 4;

/// The queue of a local socket holds ten datagrams where the system is not told otherwise.
constexpr std::size_t kInboxFrames = 100'000;
/// Longer than a member waits for others while it holds the bus.
constexpr Duration kLockLimit = std::chrono::seconds(1);
constexpr Duration kPause = std::chrono::microseconds(50);

Datagram datagram_of(const Frame& frame) {
  Datagram raw{};
  std::copy(kMagic.begin(), kMagic.end(), raw.begin());
  raw[kFlagsAt] = static_cast<std::uint8_t>((frame.extended ? kExtended : 0U) |
                                            (frame.remote ? kRemote : 0U) | (frame.error ? kError : 0U));
  raw[kSizeAt] = frame.size;
  store_le(frame.id, std::span(raw).subspan<kIdAt, 4>());
  std::copy(frame.data.begin(), frame.data.end(), raw.begin() + kDataAt);
  return raw;
}

/// Empty when the datagram does not come from a servoctl of this version.
std::optional<Frame> frame_of(const Datagram& raw) {
  if (!std::equal(kMagic.begin(), kMagic.end(), raw.begin()) || raw[kSizeAt] > 8) return std::nullopt;
  Frame frame;
  frame.extended = (raw[kFlagsAt] & kExtended) != 0;
  frame.remote = (raw[kFlagsAt] & kRemote) != 0;
  frame.error = (raw[kFlagsAt] & kError) != 0;
  frame.size = raw[kSizeAt];
  frame.id = static_cast<std::uint32_t>(load_le(std::span(raw).subspan<kIdAt, 4>()));
  std::copy(raw.begin() + kDataAt, raw.end(), frame.data.begin());
  return frame;
}

tl::unexpected<Error> busy(std::string_view name, const LocalDirectory& directory) {
  return fail(Errc::bus,
              message("local:{} stays busy: a stopped or hanging process holds it", as_it_is(name)),
              message("`fuser -v {}/lock` lists the processes on this bus; end the culprit",
                      as_it_is(directory.path())));
}

/// The process ids of `member-PID-N`, with spaces between them as `kill` wants them.
std::string process_ids(const std::vector<std::string>& members) {
  std::vector<std::string_view> ids;
  for (const std::string_view member : members) {
    const auto from = member.find('-') + 1;
    ids.push_back(member.substr(from, member.rfind('-') - from));
  }
  return formatted("{}", fmt::join(ids, " "));
}

}  // namespace

LocalBus::LocalBus(std::string name, LocalDirectory directory, Descriptor socket, std::string member,
                   Duration patience)
    : name_(std::move(name)),
      directory_(std::move(directory)),
      socket_(std::move(socket)),
      member_(std::move(member)),
      patience_(patience),
      owner_(::getpid()) {}

LocalBus::~LocalBus() {
  if (::getpid() == owner_) directory_.remove(member_);
}

Result<void> LocalBus::send(const Frame& frame) {
  const auto datagram = datagram_of(frame);
  if (!lock_until(now() + kLockLimit)) return busy(name_, directory_);
  deliver_all(datagram);
  directory_.unlock();
  return {};
}

/// Two members that send to each other would wait for each other if they did not read in the meantime.
bool LocalBus::lock_until(TimePoint limit) {
  while (!directory_.try_lock()) {
    if (now() >= limit) return false;
    drain();
    nap(kPause);
  }
  return true;
}

void LocalBus::deliver_all(std::span<const std::uint8_t> datagram) {
  auto waiting = directory_.members();
  std::erase(waiting, member_);
  std::erase_if(waiting, [&](const auto& member) {
    const bool done = deliver(datagram, member);
    if (done) lagging_.erase(member);
    return done || lagging_.count(member) != 0;
  });
  const auto limit = now() + patience_;
  while (!waiting.empty() && now() < limit) {
    drain();
    nap(kPause);
    std::erase_if(waiting, [&](const auto& member) { return deliver(datagram, member); });
  }
  if (!waiting.empty()) give_up(waiting);
}

void LocalBus::give_up(const std::vector<std::string>& members) {
  lagging_.insert(members.begin(), members.end());
  notices_.push_back(
      message("process {0} does not read local:{1} and loses frames; resume it (`kill -CONT {0}`) or end "
              "it (`kill {0}`)",
              as_it_is(process_ids(members)), name_));
}

/// False while the member cannot take the frame.
bool LocalBus::deliver(std::span<const std::uint8_t> datagram, const std::string& member) const {
  switch (directory_.deliver(socket_.get(), datagram, member)) {
    case LocalDirectory::Delivery::done: return true;
    case LocalDirectory::Delivery::gone: directory_.remove(member); return true;
    case LocalDirectory::Delivery::full: return false;
  }
  return true;
}

void LocalBus::drain() {
  while (inbox_.size() < kInboxFrames) {
    const auto frame = take();
    if (!frame) return;
    inbox_.push_back(*frame);
  }
}

/// What is there without waiting.
std::optional<Frame> LocalBus::take() const {
  for (;;) {
    Datagram raw{};
    const auto size = ::recv(socket_.get(), raw.data(), raw.size(), MSG_DONTWAIT | MSG_TRUNC);
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) return std::nullopt;
    if (static_cast<std::size_t>(size) != raw.size()) continue;
    if (const auto frame = frame_of(raw)) return frame;
  }
}

Result<std::optional<Frame>> LocalBus::receive(TimePoint deadline) {
  if (!inbox_.empty()) {
    const std::optional<Frame> frame = inbox_.front();
    inbox_.pop_front();
    return frame;
  }
  for (;;) {
    const auto frame = take();
    if (frame || now() >= deadline) return frame;
    if (wait_or_signal(socket_.get(), POLLIN, deadline) == Wake::interrupted) return frame;
  }
}

Result<std::unique_ptr<Bus>> open_local(std::string_view name, Duration patience) {
  if (const auto named = check_local_name(name); !named) return fail(named.error());
  auto directory = LocalDirectory::open(name);
  if (!directory) return fail(directory.error());
  Descriptor socket(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!socket)
    return fail(Errc::bus, message("cannot open local:{}: {}", as_it_is(name), system_text(errno)));
  // Room for a queue of one member that does not read, so that the others still get theirs.
  constexpr int kSendBytes = 1 << 20;
  ::setsockopt(socket.get(), SOL_SOCKET, SO_SNDBUF, &kSendBytes, sizeof kSendBytes);
  const auto limit = steady_now() + kLockLimit;
  while (!directory->try_lock()) {
    if (steady_now() >= limit) return busy(name, *directory);
    nap(kPause);
  }
  auto member = directory->join(socket.get());
  directory->unlock();
  if (!member) return fail(member.error());
  return std::make_unique<LocalBus>(std::string(name), std::move(*directory), std::move(socket),
                                    std::move(*member), patience);
}

}  // namespace servoctl::can
