#include "can/trace.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"

namespace servoctl::can {
namespace {

using std::chrono::microseconds;

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

}  // namespace

std::string to_string(const LogFrame& line) {
  const auto time = line.time.count();
  return formatted("({:010}.{:06}) {} {}", time / 1'000'000, time % 1'000'000, line.interface_name,
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

TraceBus::TraceBus(std::unique_ptr<Bus> inner, TraceFile file, std::string interface_name,
                   Duration clock_offset)
    : file_(std::move(file)),
      inner_(std::move(inner)),
      interface_name_(std::move(interface_name)),
      clock_offset_(clock_offset) {}

Result<void> TraceBus::send(const Frame& frame) {
  auto result = inner_->send(frame);
  if (result)
    record(frame, now());
  else
    flush_trace();
  return result;
}

Result<std::optional<Frame>> TraceBus::receive(TimePoint deadline) {
  auto result = inner_->receive(std::min(deadline, file_.flush_due()));
  const bool woken_to_flush = result && !*result && now() >= file_.flush_due() && now() < deadline;
  file_.flush_when_due(now());
  if (woken_to_flush) result = inner_->receive(deadline);
  if (!result)
    flush_trace();
  else if (*result)
    record(**result, arrived());
  return result;
}

TimePoint TraceBus::next_event() const { return std::min(inner_->next_event(), file_.flush_due()); }

void TraceBus::record(const Frame& frame, TimePoint time) {
  if (!file_) return;
  file_.put(to_string(LogFrame{time.time_since_epoch() + clock_offset_, interface_name_, frame}) + '\n',
            now());
}

std::vector<Message> TraceBus::take_notices() {
  auto out = inner_->take_notices();
  if (auto notice = file_.take_notice()) out.push_back(std::move(*notice));
  return out;
}

Result<std::unique_ptr<Bus>> trace_to(std::unique_ptr<Bus> inner, const std::filesystem::path& file,
                                      std::string_view interface_name, TraceClock clock, TraceFailed failed) {
  auto log = TraceFile::open(file, std::move(failed));
  if (!log) return fail(log.error());
  const auto offset = trace_offset(clock, inner->now());
  return std::make_unique<TraceBus>(std::move(inner), std::move(*log), std::string(interface_name), offset);
}

Duration trace_offset(TraceClock clock, TimePoint now) {
  const auto wall = std::chrono::duration_cast<Duration>(std::chrono::system_clock::now().time_since_epoch());
  return clock == TraceClock::wall ? wall - now.time_since_epoch() : Duration::zero();
}

}  // namespace servoctl::can
