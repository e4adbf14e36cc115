#include "cli/terminal/progress.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <string>

namespace servoctl::cli {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kBarWidth = 30;

/// `[###...]  25%` of a total above 0.
std::string bar(std::size_t done, std::size_t total) {
  const auto filled = std::min(kBarWidth, kBarWidth * done / total);
  return fmt::format("[{}{}] {:3}%", std::string(filled, '#'), std::string(kBarWidth - filled, '.'),
                     std::min<std::size_t>(100, 100 * done / total));
}

std::string line_of(std::size_t done, std::optional<std::size_t> total, double bytes_per_second) {
  const auto rate = fmt::format("{:.1f} kB/s", bytes_per_second / 1000);
  if (!total || *total == 0) return fmt::format("{} bytes, {}", done, rate);
  return fmt::format("{} of {} bytes, {}", bar(done, *total), *total, rate);
}

}  // namespace

bool Progress::is_due(TimePoint now) {
  if (!begin_) {
    begin_ = now;
    next_ = now + milliseconds(300);
  }
  if (now < next_) return false;
  next_ = now + milliseconds(100);
  shown_ = true;
  return true;
}

void Progress::update(std::size_t done, std::optional<std::size_t> total, TimePoint now) {
  if (!is_due(now)) return;
  const std::chrono::duration<double> elapsed = now - *begin_;
  console_->show_progress(
      console_->in_language(line_of(done, total, static_cast<double>(done) / elapsed.count())));
}

void Progress::update_list(std::size_t done, std::size_t total, TimePoint now) {
  if (total > 0 && is_due(now))
    console_->show_progress(console_->in_language(fmt::format("{} of {} objects", bar(done, total), total)));
}

void Progress::end() {
  if (shown_) console_->show_progress({});
  shown_ = false;
  begin_.reset();
}

}  // namespace servoctl::cli
