#include "cli/terminal/window_reader.hpp"

#include <algorithm>
#include <cstddef>
#include <string>

#include "base/format.hpp"
#include "base/text.hpp"
#include "cli/terminal/signals.hpp"

namespace servoctl::cli {
namespace {

using Key = command::Keys::Key;

class WindowReader {
 public:
  WindowReader(Console& console, std::string_view text)
      : console_(&console), rest_(text), lines_(count_lines(text)) {}

  bool is_done() const { return rest_.empty(); }
  std::string_view rest() const { return rest_; }
  void show_window() { show_rows(std::max<std::size_t>(console_->height(), 2) - 1); }
  void show_line() { show_rows(1); }

  /// Where it stands, and what the keys do, in the last row.
  void show_place() const {
    console_->show_progress(console_->in_language(formatted(
        "-- line {} of {}; Space goes on, Enter by a line, q ends --", lines_ - count_lines(rest_), lines_)));
  }

 private:
  static std::size_t count_lines(std::string_view text) {
    const auto ended = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
    return ended + (text.empty() || text.back() == '\n' ? 0 : 1);
  }

  /// As many lines as fit into so many rows; one at least.
  void show_rows(std::size_t rows) {
    std::size_t end = 0;
    std::size_t used = 0;
    while (end < rest_.size()) {
      const auto stop = std::min(rest_.find('\n', end), rest_.size());
      const auto needed = rows_of(rest_.substr(end, stop - end));
      if (used > 0 && used + needed > rows) break;
      used += needed;
      end = std::min(stop + 1, rest_.size());
      if (used >= rows) break;
    }
    console_->show_progress({});
    console_->out(rest_.substr(0, end));
    rest_.remove_prefix(end);
  }

  std::size_t rows_of(std::string_view line) const {
    const auto columns = std::max<std::size_t>(console_->width(), 1);
    return std::max<std::size_t>(1, (display_width(line) + columns - 1) / columns);
  }

  Console* console_;
  std::string_view rest_;
  std::size_t lines_;
};

}  // namespace

void show_by_windows(Console& console, std::string_view text, const std::function<void()>& wait) {
  const auto keys = console.open_keys();
  if (keys == nullptr) return console.out(text);
  WindowReader reader(console, text);
  reader.show_window();
  bool moved = true;
  while (!reader.is_done() && !interrupted() && !terminated()) {
    if (moved) reader.show_place();
    wait();
    const auto key = keys->take();
    const char c = keys->character();
    if (key == Key::lost || (key == Key::other && (c == 'q' || c == 'Q'))) break;
    const bool line = key == Key::down || (key == Key::other && (c == '\n' || c == '\r'));
    moved = line || key == Key::page_down || (key == Key::other && c == ' ');
    if (!moved) continue;
    if (line)
      reader.show_line();
    else
      reader.show_window();
  }
  console.show_progress({});
  console.log_unseen(reader.rest());
}

}  // namespace servoctl::cli
