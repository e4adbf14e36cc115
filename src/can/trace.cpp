#include "can/trace.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <utility>

#include "base/number.hpp"
#include "base/text.hpp"

namespace servoctl::can {
namespace {

using std::chrono::microseconds;

constexpr Duration kFlushAfter = std::chrono::milliseconds(100);
constexpr std::size_t kFlushBytes = std::size_t{64} << 10U;
/// What is kept for a reader who does not read.
constexpr std::size_t kMostBytes = std::size_t{1} << 20U;
/// How long he is waited for at the end, as often as he takes something.
constexpr Duration kLastPatience = std::chrono::milliseconds(500);

/// The words of a line, at most one more than it may have; without a heap, as millions of lines are read.
struct Words {
  std::array<std::string_view, 5> at;
  std::size_t count = 0;
};
Words words_of(std::string_view line) {
  Words out;
  for (line = trim(line); !line.empty() && out.count < out.at.size();) {
    const auto end = std::min(line.find(' '), line.size());
    if (end > 0) out.at[out.count++] = line.substr(0, end);
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  return out;
}

/// `(1736412345.123456)`, with one to nine digits behind the point.
std::optional<Duration> parse_time(std::string_view text) {
  if (text.size() < 2 || text.front() != '(' || text.back() != ')') return std::nullopt;
  text = text.substr(1, text.size() - 2);
  const auto point = text.find('.');
  if (point > 12) return std::nullopt;
  const auto seconds = parse_digits(text.substr(0, point), 10);
  const auto behind = text.substr(point + 1);
  const auto digits = parse_digits(behind, 10);
  if (!seconds || !digits || behind.size() > 9) return std::nullopt;
  auto fraction = *digits;
  for (std::size_t i = behind.size(); i < 9; ++i) fraction *= 10;
  return microseconds(static_cast<std::int64_t>(*seconds * 1'000'000 + fraction / 1000));
}

std::string left_out_words(std::size_t frames, std::string_view file) {
  return fmt::format("{} frames are missing in the trace {}: it was not read in time", frames, file);
}

}  // namespace

std::string to_string(const LogFrame& line) {
  const auto time = line.time.count();
  return fmt::format("({:010}.{:06}) {} {}", time / 1'000'000, time % 1'000'000, line.interface_name,
                     to_string(line.frame));
}

std::optional<LogFrame> parse_log_line(std::string_view line) {
  const auto words = words_of(line);
  const bool has_direction = words.count == 4 && (words.at[3] == "R" || words.at[3] == "T");
  if (words.count != 3 && !has_direction) return std::nullopt;
  const auto time = parse_time(words.at[0]);
  const auto frame = parse_frame(words.at[2]);
  if (!time || !frame) return std::nullopt;
  return LogFrame{*time, std::string(words.at[1]), *frame};
}

TraceBus::TraceBus(std::unique_ptr<Bus> inner, Descriptor file, std::string file_name,
                   std::string interface_name, Duration clock_offset, TraceFailed failed)
    : inner_(std::move(inner)),
      file_(std::move(file)),
      file_name_(std::move(file_name)),
      interface_name_(std::move(interface_name)),
      clock_offset_(clock_offset),
      failed_(std::move(failed)) {}

TraceBus::~TraceBus() {
  flush_to_slow_reader();
  missing_ += left_out_ + static_cast<std::size_t>(std::count(buffer_.begin(), buffer_.end(), '\n'));
  if (file_ && missing_ > 0 && failed_)
    failed_(fail(Errc::file, left_out_words(missing_, file_name_), "let the reader read to the end").value());
}

Result<void> TraceBus::send(const Frame& frame) {
  auto result = inner_->send(frame);
  if (result)
    record(frame, now());
  else
    flush();
  return result;
}

Result<std::optional<Frame>> TraceBus::receive(TimePoint deadline) {
  auto result = inner_->receive(std::min(deadline, flush_due()));
  const bool woken_to_flush = result && !*result && now() >= flush_due() && now() < deadline;
  flush_when_due();
  if (woken_to_flush) result = inner_->receive(deadline);
  if (!result)
    flush();
  else if (*result)
    record(**result, arrived());
  return result;
}

TimePoint TraceBus::next_event() const { return std::min(inner_->next_event(), flush_due()); }

void TraceBus::record(const Frame& frame, TimePoint time) {
  if (!file_) return;
  if (buffer_.size() >= kMostBytes) {
    ++left_out_;
    return flush_when_due();
  }
  if (buffer_.empty()) oldest_ = now();
  buffer_ += to_string(LogFrame{time.time_since_epoch() + clock_offset_, interface_name_, frame});
  buffer_ += '\n';
  flush_when_due();
}

TimePoint TraceBus::flush_due() const { return buffer_.empty() ? kNever : oldest_ + kFlushAfter; }

void TraceBus::flush_when_due() {
  if ((buffer_.size() >= kFlushBytes && !stalled_) || now() >= flush_due()) flush();
}

void TraceBus::flush() {
  std::string_view rest = buffer_;
  stalled_ = false;
  while (!rest.empty() && !stalled_) {
    const auto wrote = ::write(file_.get(), rest.data(), rest.size());
    if (wrote >= 0) {
      rest.remove_prefix(static_cast<std::size_t>(wrote));
    } else if (errno == EAGAIN) {
      stalled_ = true;
      oldest_ = now();  // Asked again when that is due.
    } else if (errno != EINTR) {
      give_up(errno);
      rest = {};
    }
  }
  buffer_.erase(0, buffer_.size() - rest.size());
}

/// No frame waits for the trace, and none is kept for it any more.
void TraceBus::give_up(int error) {
  file_ = Descriptor();
  if (failed_)
    failed_(fail(Errc::file, fmt::format("cannot write the trace {}: {}", file_name_, system_text(error)),
                 "the trace ends here; the command continues without it")
                .value());
}

/// What is left in the buffer then is lost.
void TraceBus::flush_to_slow_reader() {
  flush();
  for (auto before = buffer_.size() + 1; stalled_ && buffer_.size() < before;) {
    before = buffer_.size();
    if (wait_or_signal(file_.get(), POLLOUT, steady_now() + kLastPatience) != Wake::ready) return;
    flush();
  }
}

std::vector<std::string> TraceBus::take_notices() {
  auto out = inner_->take_notices();
  if (const auto count = std::exchange(left_out_, 0); count > 0) {
    missing_ += count;
    out.push_back(left_out_words(count, file_name_));
  }
  return out;
}

namespace {

/// Never waits for a reader: neither here nor when it is written.
Result<Descriptor> open_trace(const std::filesystem::path& file) {
  constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NONBLOCK | O_NOCTTY;
  Descriptor log(::open(file.c_str(), kFlags, 0666));
  if (log) return log;
  if (errno == ENXIO)
    return fail(Errc::file,
                fmt::format("cannot write the trace {}: nobody reads this pipe or socket", file.string()),
                "start its reader first, such as `cat` on the pipe");
  return fail(Errc::file, fmt::format("cannot write the trace {}: {}", file.string(), system_text(errno)),
              "choose an existing folder you may write to");
}

}  // namespace

Result<std::unique_ptr<Bus>> trace_to(std::unique_ptr<Bus> inner, const std::filesystem::path& file,
                                      std::string_view interface_name, TraceClock clock, TraceFailed failed) {
  auto log = open_trace(file);
  if (!log) return fail(log.error());
  // Taken once, so that a step of the system clock does not tear the trace apart.
  const auto wall = std::chrono::duration_cast<Duration>(std::chrono::system_clock::now().time_since_epoch());
  const auto offset = clock == TraceClock::wall ? wall - inner->now().time_since_epoch() : Duration::zero();
  return std::make_unique<TraceBus>(std::move(inner), std::move(*log), file.string(),
                                    std::string(interface_name), offset, std::move(failed));
}

}  // namespace servoctl::can
