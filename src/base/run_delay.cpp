#include "base/run_delay.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <charconv>
#include <cstdint>

#include "base/text.hpp"

namespace servoctl {

std::optional<Duration> parse_run_delay(std::string_view text) {
  // Time on a processor, time in its queue, both in ns, and how often.
  const auto words = split(trim(text), ' ');
  if (words.size() != 3) return std::nullopt;
  std::uint64_t nanoseconds = 0;
  const auto* end = words[1].data() + words[1].size();
  const auto read = std::from_chars(words[1].data(), end, nanoseconds);
  if (read.ec != std::errc() || read.ptr != end) return std::nullopt;
  return Duration(static_cast<Duration::rep>(nanoseconds / 1000));
}

Duration run_delay() {
  const int file = ::open("/proc/thread-self/schedstat", O_RDONLY | O_CLOEXEC);
  if (file < 0) return Duration::zero();
  std::array<char, 128> text{};
  const auto size = ::read(file, text.data(), text.size());
  ::close(file);
  if (size <= 0) return Duration::zero();
  return parse_run_delay({text.data(), static_cast<std::size_t>(size)}).value_or(Duration::zero());
}

}  // namespace servoctl
