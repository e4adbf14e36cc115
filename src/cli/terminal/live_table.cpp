#include "cli/terminal/live_table.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <numeric>
#include <utility>

#include "base/format.hpp"
#include "base/printable.hpp"
#include "base/text.hpp"
#include "cli/terminal/ascii_form.hpp"
#include "report/catalogue.hpp"

namespace servoctl::cli {
namespace {

constexpr std::size_t kGap = 2;
constexpr std::size_t kPlotColumns = 24;
constexpr std::size_t kLeastPlot = 6;
constexpr std::size_t kLeastColumn = 6;
constexpr std::string_view kKeys = "space: pause  s: sort  q: quit";

std::optional<double> number_at_front(std::string_view text) {
  double out = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), out);
  return read.ec == std::errc() ? std::optional(out) : std::nullopt;
}

/// Numbers by their size, before texts by their letters.
bool stands_before(std::string_view a, std::string_view b) {
  const auto left = number_at_front(a);
  const auto right = number_at_front(b);
  if (left && right && *left != *right) return *left < *right;
  if (left.has_value() != right.has_value()) return left.has_value();
  return a < b;
}

}  // namespace

std::string sparkline(const std::deque<double>& values, std::size_t width) {
  constexpr std::array<std::string_view, 8> kBlocks = {"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  const auto count = std::min(values.size(), width);
  if (count == 0) return {};
  const auto begin = values.end() - static_cast<std::ptrdiff_t>(count);
  const auto [least, most] = std::minmax_element(begin, values.end());
  std::string out;
  for (auto at = begin; at != values.end(); ++at) {
    const double share = *most > *least ? (*at - *least) / (*most - *least) : 0.5;
    out += kBlocks[std::min<std::size_t>(kBlocks.size() - 1, static_cast<std::size_t>(share * 8))];
  }
  return out;
}

void LiveTable::set(std::string_view row, std::vector<std::string> cells, std::optional<double> number) {
  auto place = places_.find(row);
  if (place == places_.end()) {
    place = places_.emplace(std::string(row), rows_.size()).first;
    rows_.emplace_back();
  }
  cells.resize(layout_.columns.size());
  auto& entry = rows_[place->second];
  entry.cells = std::move(cells);
  entry.number = number;
}

void LiveTable::sort_by_next() {
  const auto next = sorted_by_ ? *sorted_by_ + 1 : 0;
  sorted_by_ = next < layout_.columns.size() ? std::optional(next) : std::nullopt;
}

void LiveTable::scroll(int rows) {
  if (rows < 0)
    first_ -= std::min(first_, static_cast<std::size_t>(-rows));
  else
    first_ += static_cast<std::size_t>(rows);
}

void LiveTable::update() {
  if (paused_) return;
  for (auto& row : rows_) {
    if (const auto number = std::exchange(row.number, std::nullopt)) row.plotted.push_back(*number);
    if (row.plotted.size() > kMostPlotted) row.plotted.pop_front();
  }
  shown_ = rows_;
}

std::string LiveTable::in_charset(std::string_view text) const {
  return ascii_ ? ascii_form(text) : std::string(text);
}

std::string LiveTable::cut(std::string_view text, std::size_t width) const {
  return ascii_ ? ascii_clip(text, width) : clip(text, width);
}

/// In the language of who reads.
std::string LiveTable::shown(std::string_view text) {
  constexpr std::size_t kMostKnown = 4096;
  if (!chinese_) return in_charset(text);
  if (const auto found = known_.find(text); found != known_.end()) return found->second;
  if (known_.size() >= kMostKnown) known_.clear();
  return known_.emplace(std::string(text), report::in_chinese(text)).first->second;
}

std::string LiveTable::cell(const Row& row, std::size_t column) {
  const auto& title = layout_.columns[column].title;
  const auto& text = row.cells[column];
  return printable(title == "node" || title == "name" ? in_charset(text) : shown(text));
}

void LiveTable::measure() {
  widest_.resize(layout_.columns.size());
  for (std::size_t i = 0; i < widest_.size(); ++i) {
    widest_[i] = std::max(widest_[i],
                          display_width(shown(layout_.columns[i].title)) + 1);  // And the mark of the order.
    for (const auto& row : shown_) widest_[i] = std::max(widest_[i], display_width(cell(row, i)));
  }
}

std::vector<const LiveTable::Row*> LiveTable::in_order() const {
  std::vector<const Row*> out;
  for (const auto& row : shown_) out.push_back(&row);
  if (sorted_by_)
    std::stable_sort(out.begin(), out.end(), [&](const Row* a, const Row* b) {
      return stands_before(a->cells[*sorted_by_], b->cells[*sorted_by_]);
    });
  return out;
}

std::vector<std::size_t> LiveTable::fitted(std::size_t width) const {
  auto out = widest_;
  const auto total = [&] { return std::accumulate(out.begin(), out.end(), kGap * (out.size() - 1)); };
  const auto plain = total();
  out.push_back(layout_.plots ? kPlotColumns : 0);
  if (plain + kGap + kPlotColumns > width)
    out.back() = layout_.plots && plain + kGap + kLeastPlot <= width ? width - plain - kGap : 0;
  while (total() > width + (out.back() == 0 ? kGap : 0)) {
    const auto widest = std::max_element(out.begin(), out.end());
    if (*widest <= kLeastColumn) break;
    --*widest;
  }
  return out;
}

std::string LiveTable::line(const std::vector<std::string>& cells,
                            const std::vector<std::size_t>& widths) const {
  std::string out;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto cell = cut(cells[i], widths[i]);
    if (i > 0) out.append(kGap, ' ');
    out += i < layout_.columns.size() && layout_.columns[i].right ? pad_left(cell, widths[i])
                                                                  : pad_right(cell, widths[i]);
  }
  out.erase(out.find_last_not_of(' ') + 1);
  return out;
}

std::string LiveTable::footer(std::size_t first, std::size_t shown) const {
  std::string out(paused_ ? "PAUSED  " : "");
  out += kKeys;
  if (shown < shown_.size())
    out += formatted("  up, down: rows {} to {} of {}", first + 1, first + shown, shown_.size());
  return out;
}

std::vector<std::string> LiveTable::lines(std::size_t width, std::size_t height) {
  measure();
  const auto widths = fitted(width);
  std::vector<std::string> head;
  for (const auto& column : layout_.columns) head.push_back(shown(column.title));
  if (sorted_by_) head[*sorted_by_] += '*';
  const std::size_t others = remark_.empty() ? 2 : 3;  // Heading, remark, keys.
  const auto room = height > others ? height - others : 0;
  const auto rows = in_order();
  const auto count = std::min(room, rows.size());
  first_ = std::min(first_, rows.size() - count);
  std::vector<std::string> out = {line(head, widths)};
  for (std::size_t i = first_; i < first_ + count; ++i) {
    std::vector<std::string> cells;
    for (std::size_t column = 0; column < rows[i]->cells.size(); ++column)
      cells.push_back(cell(*rows[i], column));
    cells.push_back(in_charset(sparkline(rows[i]->plotted, widths.back())));
    out.push_back(line(cells, widths));
  }
  if (!remark_.empty()) out.push_back(printable(shown(remark_)));
  out.push_back(shown(footer(first_, count)));
  for (auto& each : out) each = cut(each, width);
  if (out.size() > height) out.resize(height);
  return out;
}

}  // namespace servoctl::cli
