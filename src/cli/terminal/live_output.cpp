#include "cli/terminal/live_output.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <span>

#include "base/signal_wait.hpp"

namespace servoctl::cli {

/// O_NONBLOCK belongs to the open file, which the shell and other programs share: it is set on one of our
/// own.
void LiveOutput::open() {
  struct stat info {};
  if (own_ >= 0 || ::fstat(descriptor_, &info) != 0) return;
  // A file takes everything at once, and one opened again would be written from its beginning.
  is_file_ = S_ISREG(info.st_mode);
  is_socket_ = S_ISSOCK(info.st_mode);
  if (is_file_ || is_socket_) return;
  own_ = ::open(("/proc/self/fd/" + std::to_string(descriptor_)).c_str(),
                O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
}

void LiveOutput::close() {
  if (own_ >= 0) ::close(own_);
  own_ = -1;
}

/// Bytes that were taken; -1 with errno.
std::ptrdiff_t LiveOutput::pass(std::string_view text) const {
  if (own_ >= 0) return ::write(own_, text.data(), text.size());
  if (is_socket_) return ::send(descriptor_, text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  pollfd ready{descriptor_, POLLOUT, 0};
  if (::poll(&ready, 1, 0) <= 0) {
    errno = EAGAIN;
    return -1;
  }
  // Ready means room for one byte.
  return ::write(descriptor_, text.data(), is_file_ ? text.size() : 1);
}

int LiveOutput::wait_for_room(Duration patience) const {
  pollfd room{own_ >= 0 ? own_ : descriptor_, POLLOUT, 0};
  return wait_or_signal(std::span(&room, 1), patience);
}

int LiveOutput::wait_for_room(Duration patience, const std::function<Duration()>& pulse) const {
  for (auto left = patience;;) {
    const auto slice = pulse ? std::min(left, pulse()) : left;
    if (slice <= Duration::zero()) return 0;
    const int ready = wait_for_room(slice);
    left -= slice;
    if (ready != 0 || left <= Duration::zero()) return ready;
  }
}

void LiveOutput::offer(std::string_view text, Duration patience, const std::function<Duration()>& pulse) {
  if (error_ != 0) return;
  if (waiting_.size() < kMost)
    waiting_ += text;
  else if (!text.empty())
    ++left_out_;
  pass_on();
  while (!waiting_.empty() && error_ == 0 && !stalled_ && patience > Duration::zero()) {
    const int ready = wait_for_room(patience, pulse);
    if (ready < 0) return;
    stalled_ = ready == 0;
    pass_on();
  }
}

void LiveOutput::write(std::string_view text) {
  const auto before = signals_noted();
  const auto all = waiting_.empty() ? std::string() : take_waiting().append(text);
  std::string_view rest = all.empty() ? text : all;
  while (!rest.empty()) {
    const auto taken = ::write(descriptor_, rest.data(), rest.size());
    if (taken >= 0) {
      rest.remove_prefix(static_cast<std::size_t>(taken));
      continue;
    }
    const int error = errno;
    if (error == EAGAIN) (void)wait_for_room(std::chrono::seconds(1));
    if (signals_noted() == before && (error == EINTR || error == EAGAIN)) continue;
    if (error_ == 0) error_ = error;
    return;
  }
}

void LiveOutput::forget_signal() {
  if (error_ == EINTR) error_ = 0;
}

void LiveOutput::give_up() {
  if (!take_waiting().empty() && error_ == 0) error_ = ETIMEDOUT;
}

/// Passes on what waits, as much as is taken.
void LiveOutput::pass_on() {
  std::size_t gone = 0;
  while (gone < waiting_.size()) {
    const auto taken = pass(std::string_view(waiting_).substr(gone));
    if (taken < 0 && errno == EINTR) continue;
    if (taken < 0 && errno != EAGAIN) error_ = errno;
    if (taken <= 0) break;
    gone += static_cast<std::size_t>(taken);
  }
  waiting_.erase(0, gone);
  if (gone > 0) stalled_ = false;
}

}  // namespace servoctl::cli
