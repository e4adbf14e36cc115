#include "can/descriptor.hpp"

#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <ctime>
#include <system_error>

namespace servoctl::can {

Descriptor::~Descriptor() {
  if (fd_ >= 0) ::close(fd_);
}

Wake wait_for(int fd, short events, TimePoint deadline) {
  const auto start = steady_now();
  const auto left = deadline > start ? deadline - start : Duration::zero();
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(left);
  timespec limit{};
  limit.tv_sec = static_cast<std::time_t>(seconds.count());
  limit.tv_nsec = static_cast<long>(std::chrono::nanoseconds(left - seconds).count());
  pollfd entry{fd, events, 0};
  const int count = ::ppoll(&entry, 1, deadline == kNever ? nullptr : &limit, nullptr);
  if (count > 0) return Wake::ready;
  return count == 0 ? Wake::elapsed : Wake::interrupted;
}

void nap(Duration time) { wait_for(-1, 0, steady_now() + time); }

std::string system_text(int error) { return std::generic_category().message(error); }

}  // namespace servoctl::can
