#include "cli/terminal/terminal_view.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "base/number.hpp"
#include "cli/terminal/signals.hpp"

namespace servoctl::cli {
namespace {

using command::Keys;

constexpr Duration kLeastBetween = std::chrono::milliseconds(100);
constexpr std::string_view kToAlternate = "\033[?1049h\033[H";
constexpr std::string_view kFromAlternate = "\033[?1049l";
constexpr std::string_view kNode = "node";
constexpr std::string_view kToLeft = "\r";
constexpr std::string_view kRestOfLine = "\033[K";
constexpr std::string_view kRestOfScreen = "\033[J";
constexpr std::string_view kHome = "\033[H";

}  // namespace

TerminalView::TerminalView(Layout layout, Screen screen, std::unique_ptr<Keys> keys)
    : table_(layout),
      alternate_(layout.alternate_screen),
      screen_(std::move(screen)),
      keys_(std::move(keys)),
      resumed_(times_resumed()) {
  for (const auto& column : layout.columns) titles_.push_back(column.title);
  if (!alternate_) return;
  words_before_ = keep_last_words(kFromAlternate);
  last_words_ = std::string(kFromAlternate) + std::string(words_before_);
  keep_last_words(last_words_);
  screen_.write(kToAlternate);
}

TerminalView::~TerminalView() {
  if (alternate_) {
    screen_.write(kFromAlternate);
    keep_last_words(words_before_);
  } else {
    draw();
  }
  if (screen_.closed) screen_.closed();
}

void TerminalView::set(std::string_view row, std::vector<std::string> cells, std::optional<double> number) {
  for (std::size_t i = 0; i < std::min(cells.size(), titles_.size()); ++i)
    if (titles_[i] == kNode) cells[i] = name_of(std::move(cells[i]));
  table_.set(row, std::move(cells), number);
}

void TerminalView::remark(std::string text) { table_.remark(names().in(text)); }

std::string TerminalView::name_of(std::string node) const {
  const auto number = parse_digits(node, 10);
  const auto name =
      number && *number <= 127 ? names().of(static_cast<std::uint8_t>(*number)) : std::string_view();
  return name.empty() ? std::move(node) : std::string(name);
}

void TerminalView::refresh(TimePoint now) {
  take_keys();
  if (drawn_ && now < *drawn_ + kLeastBetween) return;
  drawn_ = now;
  draw();
}

/// Rows that the page keys scroll by: half a window, so that one sees where one was.
int TerminalView::page() const { return static_cast<int>(std::max<std::size_t>(screen_.size().rows, 2) / 2); }

void TerminalView::take_keys() {
  if (!keys_) return;
  for (auto key = keys_->take(); key != Keys::Key::none && !over_; key = keys_->take()) {
    switch (key) {
      case Keys::Key::up: table_.scroll(-1); break;
      case Keys::Key::down: table_.scroll(1); break;
      case Keys::Key::page_up: table_.scroll(-page()); break;
      case Keys::Key::page_down: table_.scroll(page()); break;
      case Keys::Key::lost: over_ = true; break;
      case Keys::Key::other:
        if (keys_->character() == ' ') table_.pause();
        if (keys_->character() == 's') table_.sort_by_next();
        if (keys_->character() == 'q') over_ = true;
        break;
      default: break;
    }
  }
}

/// A terminal of another size has broken the lines anew, or not: what stood there is pushed up, and the table
/// begins at the top.
std::string TerminalView::to_top(Screen::Size size) const {
  if (height_ == 0) return std::string(kToLeft);
  if (alternate_) return std::string(kHome);
  if (size_ != size) return "\r\n" + std::string(size.rows, '\n') + std::string(kHome);
  return formatted("\r\033[{}A", height_);
}

void TerminalView::draw() {
  const auto size = screen_.size();
  // The last line stays free for the cursor, the last column for terminals that break a full line.
  if (size.rows < 3 || size.columns < 2) return;
  table_.update();
  // Ctrl-Z gave the screen back.
  const auto resumed = times_resumed();
  const bool anew = std::exchange(resumed_, resumed) != resumed;
  if (anew) height_ = 0;
  auto out = (anew && alternate_ ? std::string(kToAlternate) : std::string()) + to_top(size);
  const auto lines = table_.lines(size.columns - 1, size.rows - 1);
  for (const auto& line : lines) (out += line).append(kRestOfLine).append("\r\n");
  out += kRestOfScreen;
  height_ = lines.size();
  size_ = size;
  screen_.write(out);
}

void TerminalView::step_aside() {
  if (height_ == 0 || alternate_) return;
  screen_.write(formatted("\r\033[{}A{}", height_, kRestOfScreen));
  height_ = 0;
}

}  // namespace servoctl::cli
