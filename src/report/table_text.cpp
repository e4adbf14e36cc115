#include "report/table_text.hpp"

#include <algorithm>

#include "base/text.hpp"
#include "base/utf8.hpp"

namespace servoctl::report {
namespace {

constexpr std::size_t kLeftAlone = 12;    ///< A column this wide gives way last.
constexpr std::size_t kLongestWord = 32;  ///< What is longer is broken anywhere.
constexpr std::size_t kMostLines = 12;    ///< Of a cell.
constexpr std::size_t kMostBytes = 4096;  ///< Of a cell that are looked at.

/// The bytes of the longest beginning that is no wider.
std::size_t fitting(std::string_view text, std::size_t width) {
  std::size_t used = 0;
  std::size_t at = 0;
  while (at < text.size()) {
    const auto c = decode_utf8(text.substr(at));
    used += c.value ? columns(*c.value) : 1;
    if (used > width) break;
    at += c.size;
  }
  return at;
}

bool is_word(std::string_view line) { return display_width(line) <= kLongestWord; }

/// Where a word that is wider than its column is broken: a range behind its `..`.
std::size_t break_of(std::string_view line, std::size_t width) {
  const auto dots = line.find("..");
  const bool is_range = dots != std::string_view::npos && dots > 0 && dots + 2 < line.size() &&
                        line[dots + 2] != '.' && line.find_first_of(" /") == std::string_view::npos;
  if (is_range && dots + 2 <= std::max(width, kLongestWord)) return dots + 2;
  return line.size();
}

/// Broken at blanks; at most kMostLines.
std::vector<std::string> lines_of(std::string_view cell, std::size_t width) {
  if (display_width(cell) <= width) return {std::string(cell)};
  std::vector<std::string> out;
  const auto broken = wrapped(cell.substr(0, kMostBytes), 0, width);
  for (auto line : split(std::string_view(broken), '\n')) {
    const bool word = is_word(line);
    while (out.size() <= kMostLines && display_width(line) > width) {
      const auto end = word ? break_of(line, width) : fitting(line, width);
      if (end == 0 || end >= line.size()) break;
      out.emplace_back(line.substr(0, end));
      line.remove_prefix(end);
    }
    out.emplace_back(line);
    if (out.size() > kMostLines) break;
  }
  if (out.size() <= kMostLines && cell.size() <= kMostBytes) return out;
  out.resize(std::min(out.size(), kMostLines));
  auto& last = out.back();
  last = clip(last + "…", width);
  return out;
}

/// Columns of the longest word, where it is none of those that are broken.
std::size_t widest_word(std::string_view cell) {
  std::size_t out = 0;
  const auto broken = wrapped(cell.substr(0, kMostBytes), 0, 1);
  for (const auto word : split(std::string_view(broken), '\n')) {
    const auto end = break_of(word, 1);
    const auto part = end < word.size() && end > 1 ? std::max(end, word.size() - end) : display_width(word);
    if (part <= kLongestWord) out = std::max(out, part);
  }
  return out;
}

class TableText {
 public:
  TableText(const Table& table, std::size_t width) {
    for (std::size_t i = 0; i < table.columns.size(); ++i)
      if (table.columns[i].show != Show::json && !is_empty(table, i)) columns_.push_back(measure(table, i));
    if (columns_.empty()) return;
    if (width > 0 && !shrink(width)) {
      add_blocks(table, width);
      return;
    }
    add_line(table, nullptr);
    for (const auto& row : table.rows) add_line(table, &row);
  }
  std::string take() { return std::move(out_); }

 private:
  struct Column {
    std::size_t index;
    std::size_t width;
    bool right;
    std::size_t word;  ///< The widest that is not broken.

    /// How wide it is where columns are to have `most`: one of at most kLeftAlone gives way last.
    std::size_t width_at(std::size_t most) const {
      const bool gives = width > kLeftAlone || most < kLeftAlone;
      return gives ? std::min(width, std::max(most, word)) : width;
    }
  };

  static bool is_empty(const Table& table, std::size_t index) {
    return !table.rows.empty() && std::all_of(table.rows.begin(), table.rows.end(), [&](const List& row) {
      const auto* text = std::get_if<std::string>(&row[index].data());
      return row[index].is_null() || (text != nullptr && text->empty());
    });
  }

  /// Numbers stand to the right, and what is hexadecimal among them too.
  static Column measure(const Table& table, std::size_t index) {
    const auto& column = table.columns[index];
    Column out{index, display_width(title_of(column)), true, widest_word(title_of(column))};
    bool any_number = false;
    for (const auto& row : table.rows) {
      const auto cell = cell_text(row[index]);
      out.width = std::max(out.width, display_width(cell));
      out.word = std::max(out.word, widest_word(cell));
      any_number = any_number || row[index].is_number();
      out.right = out.right && (row[index].is_number() || row[index].is_null() ||
                                std::holds_alternative<Hex>(row[index].data()));
    }
    const bool all_empty = std::all_of(table.rows.begin(), table.rows.end(),
                                       [&](const List& row) { return row[index].is_null(); });
    out.right = out.right && !table.rows.empty() && (any_number || all_empty);
    return out;
  }

  /// Of all columns, with the gaps.
  std::size_t width_at(std::size_t most) const {
    std::size_t out = (columns_.size() - 1) * kColumnGap;
    for (const auto& column : columns_) out += column.width_at(most);
    return out;
  }

  /// Takes what is too much from the widest columns, so that those that give are as wide as each other, or as
  /// their longest word. False where those do not fit beside each other.
  bool shrink(std::size_t width) {
    auto most = std::max(width, kLeftAlone);
    if (width_at(std::string::npos) <= width) return true;
    while (most > 0 && width_at(most) > width) --most;
    if (width_at(most) > width) return false;
    auto left = width - width_at(most);
    for (auto& column : columns_) {
      const auto wide = column.width_at(most);
      const bool takes = left > 0 && wide == most && wide < column.width;
      column.width = wide + (takes ? 1 : 0);
      left -= takes ? 1 : 0;
    }
    return true;
  }

  void add_block_line(const std::string& title, const std::string& cell, std::size_t left,
                      std::size_t width) {
    auto head = pad_right(title, left);
    for (const auto& line : lines_of(cell, width > left + kLeftAlone ? width - left : kLeftAlone)) {
      out_ += head + line + '\n';
      head.assign(left, ' ');
    }
  }

  /// A line for each cell, and an empty one between rows.
  void add_blocks(const Table& table, std::size_t width) {
    std::size_t left = 0;
    for (const auto& column : columns_)
      left = std::max(left, display_width(title_of(table.columns[column.index])));
    for (const auto& row : table.rows) {
      if (!out_.empty()) out_ += '\n';
      for (const auto& column : columns_)
        if (const auto cell = cell_text(row[column.index]); !row[column.index].is_null() && !cell.empty())
          add_block_line(title_of(table.columns[column.index]), cell, left + kColumnGap, width);
    }
  }

  void add_line(const Table& table, const List* row) {
    std::vector<std::vector<std::string>> cells;
    std::size_t lines = 1;
    for (const auto& column : columns_) {
      const auto& head = table.columns[column.index];
      const auto cell = row == nullptr ? title_of(head) : cell_text((*row)[column.index]);
      cells.push_back(lines_of(cell, column.width));
      lines = std::max(lines, cells.back().size());
    }
    for (std::size_t i = 0; i < lines; ++i) add_cells(cells, i);
  }

  void add_cells(const std::vector<std::vector<std::string>>& cells, std::size_t line_of_cell) {
    std::string line;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const auto& column = columns_[i];
      const auto text = line_of_cell < cells[i].size() ? std::string_view(cells[i][line_of_cell]) : "";
      if (i > 0) line += std::string(kColumnGap, ' ');
      line += column.right ? pad_left(text, column.width) : pad_right(text, column.width);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out_ += line + '\n';
  }

  std::vector<Column> columns_;
  std::string out_;
};

}  // namespace

std::string table_text(const Table& table, std::size_t width) { return TableText(table, width).take(); }

std::size_t room_for(const Table& table, std::size_t column, std::size_t width) {
  if (width == 0) return std::string::npos;
  std::size_t used = 0;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (i == column || table.columns[i].show == Show::json) continue;
    auto widest = display_width(title_of(table.columns[i]));
    for (const auto& row : table.rows) widest = std::max(widest, display_width(cell_text(row[i])));
    used += widest + kColumnGap;
  }
  return width - std::min(width, used);
}

}  // namespace servoctl::report
