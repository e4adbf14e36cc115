#include "can/trace_file.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "base/format.hpp"
#include "base/found_file.hpp"

namespace servoctl::can {
namespace {

constexpr Duration kFlushAfter = std::chrono::milliseconds(100);
constexpr std::size_t kFlushBytes = std::size_t{64} << 10U;
/// What is kept for a reader who does not read.
constexpr std::size_t kMostBytes = std::size_t{1} << 20U;
/// How long he is waited for at the end, as often as he takes something.
constexpr Duration kLastPatience = std::chrono::milliseconds(500);

Message left_out_words(std::size_t frames, std::string_view file) {
  return message("{} frames are missing in the trace {}: it was not read in time", frames, as_it_is(file));
}

}  // namespace

/// Never waits for a reader: neither here nor when it is written.
Result<TraceFile> TraceFile::open(const std::filesystem::path& file, TraceFailed failed) {
  constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NONBLOCK | O_NOCTTY;
  if (const auto links = check_links(file); !links) return fail(links.error());
  Descriptor log(::open(file.c_str(), kFlags, 0666));
  if (log) return TraceFile(std::move(log), file.string(), std::move(failed));
  if (errno == ENXIO)
    return fail(
        Errc::file,
        message("cannot write the trace {}: nobody reads this pipe or socket", as_it_is(file.string())),
        "start its reader first, such as `cat` on the pipe");
  return fail(Errc::file,
              message("cannot write the trace {}: {}", as_it_is(file.string()), system_text(errno)),
              "choose an existing folder you may write to");
}

TraceFile::~TraceFile() {
  failed_ = {};
  if (file_) flush(steady_now());
}

void TraceFile::end() {
  if (!file_) return;
  flush_to_slow_reader();
  missing_ += left_out_ + sizes_.size();
  if (file_ && missing_ > 0 && failed_)
    failed_(fail(Errc::file, left_out_words(missing_, name_), "let the reader read to the end").value());
  file_ = Descriptor();
}

void TraceFile::put(std::string_view record, TimePoint now) {
  if (!file_) return;
  if (buffer_.size() >= kMostBytes) {
    ++left_out_;
    return flush_when_due(now);
  }
  if (buffer_.empty()) oldest_ = now;
  buffer_ += record;
  sizes_.push_back(record.size());
  flush_when_due(now);
}

void TraceFile::put_head(std::string_view head, TimePoint now) {
  oldest_ = now;
  buffer_ += head;
  head_ = buffer_.size();
}

TimePoint TraceFile::flush_due() const { return buffer_.empty() ? kNever : oldest_ + kFlushAfter; }

void TraceFile::flush_when_due(TimePoint now) {
  if ((buffer_.size() >= kFlushBytes && !stalled_) || now >= flush_due()) flush(now);
}

void TraceFile::flush(TimePoint now) {
  std::string_view rest = buffer_;
  stalled_ = false;
  while (!rest.empty() && !stalled_) {
    const auto wrote = ::write(file_.get(), rest.data(), rest.size());
    if (wrote >= 0) {
      rest.remove_prefix(static_cast<std::size_t>(wrote));
    } else if (errno == EAGAIN) {
      stalled_ = true;
      oldest_ = now;  // Asked again when that is due.
    } else if (errno != EINTR) {
      give_up(errno);
      rest = {};
    }
  }
  drop_written(buffer_.size() - rest.size());
}

void TraceFile::drop_written(std::size_t bytes) {
  buffer_.erase(0, bytes);
  const auto of_head = std::min(head_, bytes);
  head_ -= of_head;
  bytes -= of_head;
  while (!sizes_.empty() && bytes >= sizes_.front()) {
    bytes -= sizes_.front();
    sizes_.pop_front();
  }
  if (bytes > 0) sizes_.front() -= bytes;
}

/// No record waits for the trace, and none is kept for it any more.
void TraceFile::give_up(int error) {
  file_ = Descriptor();
  if (failed_)
    failed_(fail(Errc::file, message("cannot write the trace {}: {}", as_it_is(name_), system_text(error)),
                 "the trace ends here; the command continues without it")
                .value());
}

/// What is left in the buffer then is lost.
void TraceFile::flush_to_slow_reader() {
  flush(steady_now());
  for (auto before = buffer_.size() + 1; stalled_ && buffer_.size() < before;) {
    before = buffer_.size();
    if (wait_or_signal(file_.get(), POLLOUT, steady_now() + kLastPatience) != Wake::ready) return;
    flush(steady_now());
  }
}

std::optional<Message> TraceFile::take_notice() {
  const auto count = std::exchange(left_out_, 0);
  if (count == 0) return std::nullopt;
  missing_ += count;
  return left_out_words(count, name_);
}

}  // namespace servoctl::can
