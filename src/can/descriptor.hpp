#pragma once

#include <string>
#include <utility>

#include "base/time.hpp"

namespace servoctl::can {

/// Owns a file descriptor; -1 when it owns none.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~Descriptor();

  int get() const { return fd_; }
  explicit operator bool() const { return fd_ >= 0; }
  /// Gives the descriptor away; the caller closes it.
  int release() { return std::exchange(fd_, -1); }

 private:
  int fd_ = -1;
};

/// Why a wait ended.
enum class Wake {
  ready,        ///< One of the events happened, or an error that the next call on the descriptor tells.
  elapsed,      ///< The deadline passed.
  interrupted,  ///< A signal handler ran.
};

/// Waits for `events` (POLLIN, POLLOUT) on the descriptor, with the precision of the clock; kNever waits for
/// ever.
Wake wait_for(int fd, short events, TimePoint deadline);

/// The same by wait_or_signal(): only signals that are noted end it. For waits whose end by a signal goes
/// back to whoever asks what the signal means.
Wake wait_or_signal(int fd, short events, TimePoint deadline);

/// Whether recv() on this socket waits for a slice from now on: one system call a frame instead of three, for
/// who waits where a signal may be answered a slice late. A socket that could not be told how long stays
/// non-blocking: nothing may wait without end.
bool wait_in_slices(int socket, Duration slice);

/// What became of the other end.
struct Taken {
  bool there = true;
  int error = 0;  ///< Of a connection that is lost; 0 where it was closed.
};
/// Adds what a descriptor that does not block has, 64 KiB at most: a peer that never stops sending keeps
/// nobody from looking at signals, deadlines and limits, and fills no memory.
Taken take_in(int fd, std::string& out);

/// Waits for `time`, or for a signal.
void nap(Duration time);

/// The system's text for a value of errno.
std::string system_text(int error);

}  // namespace servoctl::can
