#include "cli/terminal/progress.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/format.hpp"

namespace servoctl::cli {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kBarWidth = 30;
constexpr Duration kFirst = milliseconds(300);
constexpr Duration kPeriod = milliseconds(100);
/// So long what was told stands before it is only waited.
constexpr Duration kStands = std::chrono::seconds(1);
/// Shares of a way are counted in these.
constexpr std::size_t kParts = 1000;

/// `[###...]  25%` of a total above 0.
std::string bar(std::size_t done, std::size_t total) {
  const auto filled = std::min(kBarWidth, kBarWidth * done / total);
  return formatted("[{}{}] {:3}%", std::string(filled, '#'), std::string(kBarWidth - filled, '.'),
                   std::min<std::size_t>(100, 100 * done / total));
}

double seconds_of(Duration time) { return std::chrono::duration<double>(time).count(); }

std::string elapsed_text(double seconds) {
  if (seconds < 10) return formatted("{:.1f} s so far", seconds);
  if (seconds < 60) return formatted("{:.0f} s so far", std::floor(seconds));
  const auto whole = static_cast<long>(seconds);
  return formatted("{} min {} s so far", whole / 60, whole % 60);
}

/// Of what may be over before.
std::string most_text(double seconds) {
  if (seconds < 120) return formatted("{:.0f} s at most", seconds);
  return formatted("{:.0f} min at most", std::ceil(seconds / 60));
}

std::string line_of(std::size_t done, std::optional<std::size_t> total, double bytes_per_second) {
  const auto rate = formatted("{:.1f} kB/s", bytes_per_second / 1000);
  if (!total || *total == 0) return formatted("{} bytes, {}", done, rate);
  return formatted("{} of {} bytes, {}", bar(done, *total), *total, rate);
}

/// How long it goes on if it goes on as it did; empty where too little of it is known, or nothing is left.
std::string time_left(std::size_t done, std::size_t total, double elapsed) {
  constexpr double kLeastKnown = 0.9;
  if (done == 0 || done >= total || elapsed < kLeastKnown) return {};
  const auto seconds = std::ceil(elapsed * static_cast<double>(total - done) / static_cast<double>(done));
  if (seconds < 60) return formatted("{:.0f} s left", seconds);
  return formatted("{:.0f} min left", std::ceil(seconds / 60));
}

}  // namespace

bool Progress::is_due(TimePoint now) {
  if (!begin_) begin_ = now;
  if (now < std::max(next_, *begin_ + kFirst)) return false;
  next_ = now + kPeriod;
  shown_ = true;
  return true;
}

void Progress::update(std::size_t done, std::optional<std::size_t> total, TimePoint now) {
  told_ = now;
  if (!is_due(now)) return;
  const std::chrono::duration<double> elapsed = now - *begin_;
  show(line_of(done, total, static_cast<double>(done) / elapsed.count()),
       time_left(done, total.value_or(0), elapsed.count()));
}

void Progress::update_list(std::size_t done, std::size_t total, TimePoint now) {
  if (total == 0) return;
  // What is told too soon for the screen is told all the same: a wait does not take its turn.
  told_ = now;
  if (!is_due(now)) return;
  const std::chrono::duration<double> elapsed = now - *begin_;
  show(formatted("{} ({}/{})", bar(done, total), done, total), time_left(done, total, elapsed.count()));
}

void Progress::update_wait(const session::Stretch* stretch, TimePoint now) {
  if (lines_ == 0) return;
  const auto share = stretch != nullptr ? stretch->share(now) : std::nullopt;
  const bool is_open = !share && (stretch == nullptr || stretch->end() == kNever);
  if (std::exchange(spoke_, false) && is_open) told_ = now;
  if (!begin_) begin_ = now;
  if (now < told_ + kStands || !is_due(now)) return;
  if (!share) return show_elapsed(stretch, now);
  show_share(*share, stretch->begin(), now);
}

void Progress::update_share(double share, TimePoint begin, TimePoint now) {
  if (!begin_) begin_ = begin;
  if (is_due(now)) show_share(share, begin, now);
}

void Progress::show_share(double share, TimePoint begin, TimePoint now) {
  const auto done = static_cast<std::size_t>(std::floor(share * static_cast<double>(kParts)));
  show(bar(done, kParts), time_left(done, kParts, seconds_of(now - begin)));
}

void Progress::show_elapsed(const session::Stretch* stretch, TimePoint now) {
  if (stretch == nullptr || stretch->end() == kNever)
    return show(elapsed_text(seconds_of(now - *begin_)), {});
  show(elapsed_text(seconds_of(now - stretch->begin())),
       most_text(seconds_of(stretch->end() - stretch->begin())));
}

void Progress::show(std::string line, const std::string& left) {
  line = console_->in_language(line);
  if (!left.empty()) line += (console_->chinese() ? "，" : ", ") + console_->in_language(left);
  console_->show_progress(line);
}

void Progress::update_line(std::string_view line, TimePoint now) {
  told_ = now;
  if (!is_due(now)) return;
  console_->show_progress(console_->in_language(line));
}

void Progress::end() {
  if (shown_) console_->show_progress({});
  shown_ = false;
  begin_.reset();
  next_ = {};
  told_ = TimePoint::min();
}

}  // namespace servoctl::cli
