#include <fmt/format.h>
#include <algorithm>

#include "base/printable.hpp"
#include "base/text.hpp"
#include "base/utf8.hpp"
#include "report/line.hpp"
#include "report/plot.hpp"
#include "report/value.hpp"

namespace servoctl::report {
namespace {

template <class... Fs>
struct Overloaded : Fs... {
  using Fs::operator()...;
};
template <class... Fs>
Overloaded(Fs...) -> Overloaded<Fs...>;  // clang 14 has no aggregate deduction.

constexpr std::size_t kColumnGap = 2;
constexpr std::size_t kLeftAlone = 12;  ///< A column this wide is never made narrower.
constexpr std::size_t kMostLines = 4;   ///< Of a cell that does not fit into its column.

}  // namespace

std::string line_text(const Value& value) {
  return std::visit(Overloaded{
                        [](std::monostate) { return std::string("-"); },
                        [](bool b) { return std::string(b ? "yes" : "no"); },
                        [](std::int64_t i) { return fmt::format("{}", i); },
                        [](std::uint64_t u) { return fmt::format("{}", u); },
                        [](double d) { return fmt::format("{:.12g}", d); },
                        [](const std::string& s) { return s; },
                        [](const Hex& h) { return fmt::format("0x{:0{}X}", h.value, h.digits); },
                        [](const List& l) {
                          std::string out;
                          for (const auto& v : l) append(out, line_text(v));
                          return out;
                        },
                        [](const Record& r) {
                          std::string out;
                          for (const auto& f : r)
                            if (f.show != Show::json) append(out, f.key + "=" + line_text(f.value));
                          return out;
                        },
                        [](const Table&) { return std::string(); },
                        [](const Plot&) { return std::string(); },
                        [](const Written& w) { return w.json; },
                    },
                    value.data());
}

namespace {

/// A line for a place where a line break would spoil the layout.
std::string cell_text(const Value& value) { return printable(line_text(value)); }

/// A heading, as it is shown.
template <class T>
std::string title_of(const T& named) {
  return printable(named.title.empty() ? named.key : named.title);
}

bool has_own_lines(const Value& value) {
  return std::holds_alternative<Table>(value.data()) || std::holds_alternative<Record>(value.data()) ||
         std::holds_alternative<Plot>(value.data());
}

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

/// The cell in lines of its column: broken at blanks, and between characters where a word is wider than it.
std::vector<std::string> cell_lines(std::string_view cell, std::size_t width) {
  if (display_width(cell) <= width) return {std::string(cell)};
  std::vector<std::string> out;
  const auto broken = wrapped(cell, 0, width);
  for (auto line : split(std::string_view(broken), '\n')) {
    while (out.size() <= kMostLines && display_width(line) > width) {
      const auto end = fitting(line, width);
      out.emplace_back(line.substr(0, end));
      line.remove_prefix(end);
    }
    out.emplace_back(line);
    if (out.size() > kMostLines) break;
  }
  if (out.size() <= kMostLines) return out;
  out.resize(kMostLines);
  auto& last = out.back();
  last = clip(last + "…", width);
  return out;
}

class TableText {
 public:
  TableText(const Table& table, std::size_t width) {
    for (std::size_t i = 0; i < table.columns.size(); ++i)
      if (table.columns[i].show != Show::json && !is_empty(table, i)) columns_.push_back(measure(table, i));
    if (columns_.empty()) return;
    if (width > 0) shrink(width);
    add_line(table, nullptr);
    for (const auto& row : table.rows) add_line(table, &row);
  }
  std::string take() { return std::move(out_); }

 private:
  struct Column {
    std::size_t index;
    std::size_t width;
    bool right;
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
    Column out{index, display_width(title_of(column)), true};
    bool any_number = false;
    for (const auto& row : table.rows) {
      out.width = std::max(out.width, display_width(cell_text(row[index])));
      any_number = any_number || row[index].is_number();
      out.right = out.right && (row[index].is_number() || row[index].is_null() ||
                                std::holds_alternative<Hex>(row[index].data()));
    }
    const bool all_empty = std::all_of(table.rows.begin(), table.rows.end(),
                                       [&](const List& row) { return row[index].is_null(); });
    out.right = out.right && !table.rows.empty() && (any_number || all_empty);
    return out;
  }

  /// Of all columns where none is wider than `most`, with the gaps.
  std::size_t width_at(std::size_t most) const {
    std::size_t out = (columns_.size() - 1) * kColumnGap;
    for (const auto& column : columns_) out += std::min(column.width, most);
    return out;
  }

  /// Takes what is too much from the widest columns, so that those that give are as wide as each other; a
  /// column of at most kLeftAlone is left as it is. Nothing is lost by it but the end of what needs more than
  /// kMostLines.
  void shrink(std::size_t width) {
    if (width_at(std::string::npos) <= width) return;
    auto most = std::max(width, kLeftAlone);
    while (most > kLeftAlone && width_at(most) > width) --most;
    auto left = width - std::min(width, width_at(most));
    for (auto& column : columns_) {
      if (column.width <= most) continue;
      column.width = most + (left > 0 ? 1 : 0);
      left -= left > 0 ? 1 : 0;
    }
  }

  void add_line(const Table& table, const List* row) {
    std::vector<std::vector<std::string>> cells;
    std::size_t lines = 1;
    for (const auto& column : columns_) {
      const auto& head = table.columns[column.index];
      const auto cell = row == nullptr ? title_of(head) : cell_text((*row)[column.index]);
      cells.push_back(cell_lines(cell, column.width));
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

std::string record_text(const Record& record, std::size_t width) {
  std::size_t left = 0;
  for (const auto& field : record)
    if (field.show != Show::json && !has_own_lines(field.value))
      left = std::max(left, display_width(title_of(field)));
  std::string out;
  std::string blocks;  // Below the lines, whatever their place.
  for (const auto& field : record) {
    if (field.show == Show::json || field.value.is_null()) continue;
    if (has_own_lines(field.value))
      blocks += "\n" + title_of(field) + ":\n" + to_text(field.value, width);
    else
      out += pad_right(title_of(field), left + kColumnGap) +
             wrapped(cell_text(field.value), left + kColumnGap, width) + '\n';
  }
  return out + blocks;
}

std::string lines_below(const Table& table, std::size_t width) {
  std::string out;
  for (const auto& line : table.below) {
    const auto indent = std::min(line.find_first_not_of(' '), line.size());
    out +=
        std::string(indent, ' ') + wrapped(printable(line.substr(indent)), indent + kColumnGap, width) + '\n';
  }
  return out.empty() || table.columns.empty() ? out : '\n' + out;
}

}  // namespace

std::string to_text(const Value& value, std::size_t width) {
  if (value.is_null()) return {};
  if (const auto* table = std::get_if<Table>(&value.data()))
    return table->json_only ? std::string() : TableText(*table, width).take() + lines_below(*table, width);
  if (const auto* plot = std::get_if<Plot>(&value.data()))
    return braille_plot(plot->series, width == 0 ? kPlotWidth : std::min(width, kPlotWidth));
  if (const auto* record = std::get_if<Record>(&value.data())) return record_text(*record, width);
  if (const auto* list = std::get_if<List>(&value.data())) {
    std::string out;
    for (const auto& element : *list)
      out += (out.empty() || !has_own_lines(element) ? "" : "\n") + to_text(element, width);
    return out;
  }
  return printable_lines(line_text(value)) + '\n';
}

}  // namespace servoctl::report
