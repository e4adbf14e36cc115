#include "base/signal_wait.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>

#include "base/timespec.hpp"

namespace servoctl {
namespace {

// A signal handler can reach nothing else.
std::atomic<unsigned> g_noted{0};
std::atomic<unsigned> g_answered{0};
static_assert(std::atomic<unsigned>::is_always_lock_free);

/// A signal that was noted before is answered now.
bool take_noted() {
  const auto noted = g_noted.load();
  return g_answered.exchange(noted) != noted;
}

}  // namespace

void note_signal() { g_noted.fetch_add(1); }
unsigned signals_noted() { return g_noted.load(); }
bool signal_is_noted() { return take_noted(); }

int wait_or_signal(std::span<pollfd> descriptors, std::optional<Duration> longest) {
  if (!longest) return wait_or_signal_until(descriptors, std::nullopt);
  const auto now = steady_now();
  return wait_or_signal_until(descriptors, *longest < kNever - now ? now + *longest : kNever);
}

int wait_or_signal_until(std::span<pollfd> descriptors, std::optional<TimePoint> deadline) {
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  int count = -1;
  int error = EINTR;
  // A signal that nobody noted is none for who waits.
  while (count < 0 && error == EINTR && !take_noted()) {
    timespec limit{};
    if (deadline) limit = to_timespec(left_until(*deadline));
    count = ::ppoll(descriptors.data(), descriptors.size(), deadline ? &limit : nullptr, &before);
    error = errno;
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  errno = error;
  return count;
}

}  // namespace servoctl
