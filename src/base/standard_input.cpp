#include "base/standard_input.hpp"

#include <array>
#include <cerrno>

namespace servoctl {

bool StandardInput::take_line(std::string& line) {
  const auto end = buffer_.find('\n', taken_);
  if (end == std::string::npos && (!ended_ || taken_ == buffer_.size())) return false;
  line = buffer_.substr(taken_, end == std::string::npos ? end : end - taken_);
  taken_ = end == std::string::npos ? buffer_.size() : end + 1;
  return true;
}

bool StandardInput::read_more() {
  buffer_.erase(0, taken_);
  taken_ = 0;
  std::array<char, 65536> chunk{};
  ssize_t got = -1;
  while (!ended_ && got < 0) {
    got = ::read(descriptor_, chunk.data(), chunk.size());
    ended_ = got == 0 || (got < 0 && errno != EINTR);
  }
  if (got > 0) buffer_.append(chunk.data(), static_cast<std::size_t>(got));
  return !ended_;
}

std::string StandardInput::take_rest(std::size_t most) {
  while (buffer_.size() - taken_ <= most && read_more()) {
  }
  std::string out = buffer_.substr(taken_);
  buffer_.clear();
  taken_ = 0;
  return out;
}

StandardInput& standard_input() {
  static StandardInput input;
  return input;
}

}  // namespace servoctl
