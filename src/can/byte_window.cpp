#include "can/byte_window.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string>
#include <utility>

#include "base/format.hpp"

namespace servoctl::can {
namespace {

constexpr std::size_t kPiece = std::size_t{64} << 10U;

}  // namespace

ByteWindow::ByteWindow(Descriptor source, std::function<void()> idle)
    : source_(std::move(source)), idle_(std::move(idle)) {}

std::string_view ByteWindow::ahead(std::size_t wanted) {
  while (rest_.size() < wanted && read_more()) {
  }
  return rest_;
}

void ByteWindow::wait_for_bytes() {
  pollfd ready{source_.get(), POLLIN, 0};
  if (idle_ && ::poll(&ready, 1, 0) == 0) idle_();
}

bool ByteWindow::read_more() {
  if (ended_) return false;
  buffer_.erase(0, buffer_.size() - rest_.size());
  const auto size = buffer_.size();
  buffer_.resize(size + kPiece);
  wait_for_bytes();
  ssize_t got = -1;
  do got = ::read(source_.get(), buffer_.data() + size, kPiece);
  while (got < 0 && errno == EINTR);
  if (got < 0) error_ = errno;
  ended_ = got <= 0;
  buffer_.resize(size + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
  rest_ = buffer_;
  return !ended_;
}

void ByteWindow::drop(std::size_t count) {
  count = std::min(count, rest_.size());
  rest_.remove_prefix(count);
  offset_ += count;
}

Result<Descriptor> open_recording(std::string_view path) {
  const std::string name(path);
  Descriptor out(path == "-" ? ::dup(STDIN_FILENO) : ::open(name.c_str(), O_RDONLY | O_CLOEXEC));
  struct stat about {};
  int error = out ? 0 : errno;
  if (out && ::fstat(out.get(), &about) == 0 && S_ISDIR(about.st_mode)) error = EISDIR;
  if (error != 0) return fail(Errc::file, message("cannot open {}: {}", as_it_is(name), system_text(error)));
  return out;
}

}  // namespace servoctl::can
