#include "can/descriptor.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <optional>
#include <span>
#include <system_error>

#include "base/signal_wait.hpp"
#include "base/timespec.hpp"

namespace servoctl::can {

Descriptor::~Descriptor() {
  if (fd_ >= 0) ::close(fd_);
}

namespace {

Wake wake(int count) {
  if (count > 0) return Wake::ready;
  return count == 0 ? Wake::elapsed : Wake::interrupted;
}

}  // namespace

Wake wait_for(int fd, short events, TimePoint deadline) {
  pollfd entry{fd, events, 0};
  if (deadline == kNever) return wake(::ppoll(&entry, 1, nullptr, nullptr));
  const auto limit = to_timespec(left_until(deadline));
  return wake(::ppoll(&entry, 1, &limit, nullptr));
}

Wake wait_or_signal(int fd, short events, TimePoint deadline) {
  pollfd entry{fd, events, 0};
  const auto end = deadline == kNever ? std::nullopt : std::optional(deadline);
  return wake(servoctl::wait_or_signal_until(std::span(&entry, 1), end));
}

bool wait_in_slices(int socket, Duration slice) {
  const auto time = to_timespec(slice);
  const timeval limit{time.tv_sec, time.tv_nsec / 1000};
  return ::setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit) == 0 &&
         ::fcntl(socket, F_SETFL, ::fcntl(socket, F_GETFL) & ~O_NONBLOCK) == 0;
}

Taken take_in(int fd, std::string& out) {
  constexpr std::size_t kMostAtOnce = std::size_t{1} << 16U;
  std::array<char, 8192> bytes;
  for (std::size_t all = 0; all < kMostAtOnce;) {
    const auto count = ::read(fd, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && errno == EAGAIN) break;
    if (count <= 0) return {false, count < 0 ? errno : 0};
    out.append(bytes.data(), static_cast<std::size_t>(count));
    if (static_cast<std::size_t>(count) < bytes.size()) break;
    all += bytes.size();
  }
  return {};
}

void nap(Duration time) { wait_for(-1, 0, steady_now() + time); }

std::string system_text(int error) { return std::generic_category().message(error); }

}  // namespace servoctl::can
