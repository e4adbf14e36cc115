#include "cli/line_log.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ctime>
#include <utility>

#include "base/format.hpp"
#include "base/found_file.hpp"

namespace servoctl::cli {
namespace {

/// `2026-11-23T14:00:00.123Z`.
std::string time_of_day() {
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  std::tm utc{};
  ::gmtime_r(&now.tv_sec, &utc);
  char text[32];
  const auto size = std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &utc);
  return formatted("{}.{:03}Z", std::string_view(text, size), now.tv_nsec / 1'000'000);
}

}  // namespace

Result<std::unique_ptr<LineLog>> LineLog::open(const std::filesystem::path& file) {
  const auto name = file.string();
  const auto refused = [&](int error) {
    return fail(Errc::file, message("{}: {}", as_it_is(name), std::strerror(error)),
                "name another file, or a folder that you may write to");
  };
  // A FIFO would be waited for, a device might do anything.
  struct stat kind {};
  const bool there = ::stat(name.c_str(), &kind) == 0;
  if (there && !S_ISREG(kind.st_mode))
    return fail(Errc::file, message("{} is no regular file", as_it_is(name)), "name a file");
  if (const auto links = check_links(file); !links) return fail(links.error());
  can::Descriptor descriptor(
      ::open(name.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NONBLOCK | O_NOCTTY, 0666));
  if (!descriptor) return refused(errno);
  return std::unique_ptr<LineLog>(new LineLog(std::move(descriptor), name));
}

LineLog::~LineLog() { end_line(); }

void LineLog::typed(std::string_view line) {
  end_line();
  put(time_of_day(), "> ", line);
}

void LineLog::answered(std::string_view text) {
  while (!text.empty()) {
    if (begun_.empty()) begun_at_ = time_of_day();
    const auto end = text.find('\n');
    begun_ += text.substr(0, end);
    if (end == std::string_view::npos) return;
    put(begun_at_, "  ", std::exchange(begun_, {}));
    text.remove_prefix(end + 1);
  }
}

void LineLog::end_line() {
  if (!begun_.empty()) put(begun_at_, "  ", std::exchange(begun_, {}));
}

void LineLog::put(std::string_view time, std::string_view mark, std::string_view line) {
  if (!file_) return;
  const auto record = formatted("{} {}{}\n", time, mark, line);
  const auto written = ::write(file_.get(), record.data(), record.size());
  if (written == static_cast<ssize_t>(record.size())) return;
  const int error = written < 0 ? errno : ENOSPC;
  failure_ =
      make_error(Errc::file, message("{}: {}: the log has ended here", as_it_is(name_), std::strerror(error)),
                 "make room, then `log on FILE` goes on; what runs is not stopped by it");
  file_ = {};
}

std::optional<Error> LineLog::take_failure() { return std::exchange(failure_, std::nullopt); }

}  // namespace servoctl::cli
