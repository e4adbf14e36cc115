#include "base/csv.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"

namespace servoctl {
namespace {

/// Splits the text into records; knows nothing of columns.
class Splitter {
 public:
  Splitter(std::string_view text, char separator) : text_(text), separator_(separator) {
    if (text_.starts_with("\xEF\xBB\xBF")) at_ = 3;
  }

  bool at_end() const { return at_ >= text_.size(); }
  std::uint32_t line() const { return line_; }

  /// False when a quote is not closed before the end of the text.
  bool next(std::vector<std::string>& cells) {
    cells.clear();  // Those of the line before, or what a move left.
    cells.emplace_back();
    for (;;) {
      if (at_end()) return true;
      if (text_[at_] == '"' && cells.back().empty()) {
        if (!quoted(cells.back())) return false;
        continue;
      }
      plain(cells.back());
      if (at_end()) return true;
      const char c = text_[at_++];
      if (c == separator_) {
        cells.emplace_back();
      } else if (c == '\n') {
        ++line_;
        return true;
      } else if (!at_end() && text_[at_] != '\n') {
        cells.back() += c;  // A carriage return that ends no line.
      }
    }
  }

 private:
  void plain(std::string& cell) {
    const auto begin = at_;
    while (at_ < text_.size() && text_[at_] != separator_ && text_[at_] != '\n' && text_[at_] != '\r') ++at_;
    cell.append(text_, begin, at_ - begin);
  }

  bool quoted(std::string& cell) {
    for (++at_;;) {
      const auto end = text_.find('"', at_);
      if (end == std::string_view::npos) return false;
      const auto inside = text_.substr(at_, end - at_);
      line_ += static_cast<std::uint32_t>(std::count(inside.begin(), inside.end(), '\n'));
      cell += inside;
      at_ = end + 1;
      if (at_end() || text_[at_] != '"') return true;
      cell += text_[at_++];
    }
  }

  std::string_view text_;
  char separator_;
  std::size_t at_ = 0;
  std::uint32_t line_ = 1;
};

/// Whether a spreadsheet would take the text for a formula, were it not for apostrophes before it.
bool is_formula(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of('\''), text.size()));
  if (text.empty()) return false;
  if (text.front() == '\t' || text.front() == '\r' || text.front() == '\n') return true;
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n'"), text.size()));
  if (text.empty()) return false;
  if (std::string_view("=+-@").find(text.front()) != std::string_view::npos) return true;
  // Their full-width forms do the same.
  constexpr std::string_view kWide[] = {"＝", "＋", "－", "＠"};
  return std::any_of(std::begin(kWide), std::end(kWide), [&](auto mark) { return text.starts_with(mark); });
}

std::string in_quotes(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + '"';
}

void take_apostrophes(std::vector<std::string>& cells) {
  for (auto& cell : cells)
    if (cell.starts_with('\'') && is_formula(cell)) cell.erase(0, 1);
}

}  // namespace

std::size_t CsvTable::column(std::string_view name) const {
  return static_cast<std::size_t>(std::find(columns.begin(), columns.end(), name) - columns.begin());
}

bool CsvTable::has_columns(std::span<const std::string_view> needed, std::string_view file,
                           std::vector<Error>& errors) const {
  bool all = true;
  NameList there;
  for (const auto& each : columns) there.words.push_back(formatted("'{}'", each));
  for (const auto name : columns.empty() ? std::span<const std::string_view>() : needed) {
    if (column(name) < columns.size()) continue;
    errors.push_back(file_error(file, 1, message("column '{}' is missing", as_it_is(name)),
                                message("the columns are {}", there)));
    all = false;
  }
  return all;
}

CsvTable read_csv(std::string_view text, std::string_view file, std::vector<Error>& errors, char separator,
                  CsvRows rows) {
  CsvTable table;
  Splitter splitter(text, separator);
  std::vector<std::string> cells;
  const auto wrong = [&](std::uint32_t line, const Message& what) {
    errors.push_back(file_error(file, line, what));
  };
  while (!splitter.at_end()) {
    const auto line = splitter.line();
    if (!splitter.next(cells)) {
      wrong(line, "a quote is opened here and never closed");
      break;
    }
    if (cells.size() == 1 && cells.front().empty()) continue;
    take_apostrophes(cells);
    if (table.columns.empty()) {
      table.columns = cells;
      auto sorted = cells;
      std::sort(sorted.begin(), sorted.end());
      const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
      if (twice != sorted.end() && rows == CsvRows::exact)
        wrong(line, message("column '{}' appears twice", as_it_is(*twice)));
      continue;
    }
    if (cells.size() != table.columns.size() && rows == CsvRows::exact) {
      wrong(line, message("{} cells, but the header names {} columns", cells.size(), table.columns.size()));
      continue;
    }
    table.rows.push_back({std::move(cells), line});
    cells.reserve(table.columns.size());
  }
  if (table.columns.empty() && errors.empty())
    wrong(1, "the file is empty; a line with column names is expected");
  return table;
}

Result<CsvTable> parse_csv(std::string_view text, std::string_view file) {
  std::vector<Error> errors;
  auto table = read_csv(text, file, errors);
  if (!errors.empty()) return fail(std::move(errors.front()));
  return table;
}

std::string csv_cell(std::string_view text) {
  if (is_formula(text) && !parse_real(text)) return in_quotes("'" + std::string(text));
  return in_quotes(text);
}

std::string csv_heading(std::string_view name, std::string_view unit) {
  return csv_cell(unit.empty() ? std::string(name) : formatted("{} ({})", name, unit));
}

}  // namespace servoctl
