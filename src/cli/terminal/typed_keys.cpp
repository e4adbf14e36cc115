#include "cli/terminal/typed_keys.hpp"

#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <utility>

namespace servoctl::cli {
namespace {

constexpr std::chrono::milliseconds kFasterThanTyped{10};

}  // namespace

bool TypedKeys::wait() const {
  pollfd input{descriptor_, POLLIN, 0};
  return ::poll(&input, 1, 0) > 0;
}

std::optional<char> TypedKeys::take() {
  const auto now = std::chrono::steady_clock::now();
  burst_ = now - std::exchange(last_, now) < kFasterThanTyped;
  char byte = 0;
  return ::read(descriptor_, &byte, 1) == 1 ? std::optional(byte) : std::nullopt;
}

std::size_t TypedKeys::drop() {
  int count = 0;
  if (::ioctl(descriptor_, FIONREAD, &count) != 0) count = 0;
  (void)::tcflush(descriptor_, TCIFLUSH);
  return static_cast<std::size_t>(count);
}

}  // namespace servoctl::cli
