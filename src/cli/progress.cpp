#include "cli/progress.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <string>

namespace servoctl::cli {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kBarWidth = 30;

std::string line_of(std::size_t done, std::optional<std::size_t> total, double bytes_per_second) {
  const auto rate = fmt::format("{:.1f} kB/s", bytes_per_second / 1000);
  if (!total || *total == 0) return fmt::format("{} bytes, {}", done, rate);
  const auto filled = std::min(kBarWidth, kBarWidth * done / *total);
  return fmt::format("[{}{}] {:3}% of {} bytes, {}", std::string(filled, '#'),
                     std::string(kBarWidth - filled, '.'), std::min<std::size_t>(100, 100 * done / *total),
                     *total, rate);
}

}  // namespace

void Progress::update(std::size_t done, std::optional<std::size_t> total, TimePoint now) {
  if (!begin_) {
    begin_ = now;
    next_ = now + milliseconds(300);
  }
  if (now < next_) return;
  next_ = now + milliseconds(100);
  const std::chrono::duration<double> elapsed = now - *begin_;
  console_->show_progress(line_of(done, total, static_cast<double>(done) / elapsed.count()));
  shown_ = true;
}

void Progress::end() {
  if (shown_) console_->show_progress({});
  shown_ = false;
  begin_.reset();
}

}  // namespace servoctl::cli
