#include "drive/foreign_heading.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "base/format.hpp"
#include "base/text.hpp"
#include "base/utf8.hpp"
#include "od/text_encoding.hpp"

namespace servoctl::drive {
namespace {

constexpr std::string_view kOpening[] = {"(", "[", "（", "【", "["};
constexpr std::string_view kClosing[] = {")", "]", "）", "】", "]"};
constexpr std::string_view kNothing[] = {"-", "--", "—", "——", "–", "/", "\\", "N/A", "n/a", "NA", "无", "*"};
constexpr std::array kSeparators{',', ';', '\t'};

bool is_in(std::span<const std::string_view> words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// The heading without the first of the marks that it contains; empty: it has none.
std::string without_mark(std::string_view text, std::span<const std::string_view> marks) {
  auto out = lower(text);
  for (const auto mark : marks)
    if (const auto at = out.find(mark); at != std::string::npos)
      return folded_heading(out.erase(at, mark.size()));
  return {};
}

bool means_exactly(std::string_view text, const Heading& heading) {
  return is_in(heading.exact, folded_heading(text)) ||
         is_in(heading.loose, without_mark(text, heading.marks));
}

bool means_loosely(std::string_view text, const Heading& heading) {
  return is_in(heading.loose, folded_heading(text));
}

bool is_known(std::string_view text, std::span<const Heading> headings) {
  return std::any_of(headings.begin(), headings.end(), [&](const Heading& one) {
    return means_exactly(text, one) || means_loosely(text, one);
  });
}

/// The line of the headings: the first with two known ones.
struct HeadingLine {
  std::size_t begin = 0;
  std::uint32_t line = 1;
  char separator = ',';
};
std::optional<HeadingLine> find_headings(std::string_view text, std::span<const Heading> headings) {
  std::uint32_t line = 0;
  std::size_t begin = 0;
  for (const auto part : split(text, '\n')) {
    ++line;
    for (const char separator : kSeparators) {
      const auto cells = split(part, separator);
      const auto known = std::count_if(cells.begin(), cells.end(),
                                       [&](std::string_view cell) { return is_known(cell, headings); });
      if (known >= 2) return HeadingLine{begin, line, separator};
    }
    begin += part.size() + 1;
  }
  return std::nullopt;
}

/// Old spreadsheets end lines with a carriage return alone.
std::string with_line_feeds(std::string_view text) {
  std::string out(text);
  if (out.find('\n') == std::string::npos) std::replace(out.begin(), out.end(), '\r', '\n');
  return out;
}

/// Whether a heading says in which base the numbers below it are.
bool names_base(std::string_view heading) {
  if (heading.find("进制") != std::string_view::npos) return true;
  constexpr std::string_view kBases[] = {"dec", "decimal", "hex", "hexadecimal", "hexa"};
  std::string word;
  for (const char c : lower(heading) + ' ') {
    if (c >= 'a' && c <= 'z') {
      word += c;
      continue;
    }
    if (std::find(std::begin(kBases), std::end(kBases), word) != std::end(kBases)) return true;
    word.clear();
  }
  return false;
}

bool has_bracket(std::string_view heading) {
  return std::any_of(std::begin(kOpening), std::end(kOpening),
                     [&](auto one) { return heading.find(one) != std::string_view::npos; });
}

/// What a heading may say in brackets over numbers without changing them.
bool is_harmless(std::string_view heading) {
  constexpr std::string_view kHarmless[] = {"canopen", "can", "603f", "603fh", "0x603f", "emcy", "od"};
  for (std::size_t i = 0; i < std::size(kOpening); ++i) {
    const auto begin = heading.find(kOpening[i]);
    if (begin == std::string_view::npos) continue;
    const auto inside = heading.substr(begin + kOpening[i].size());
    const auto text = folded_heading(inside.substr(0, inside.find(kClosing[i])));
    return std::find(std::begin(kHarmless), std::end(kHarmless), text) != std::end(kHarmless);
  }
  return true;
}

/// The first character that folded_heading() leaves out and that may say something of the numbers: `%`.
std::string_view unread_mark(std::string_view heading) {
  constexpr std::string_view kPlain = " .:_-\t\r\n\"'()[]";
  const auto at = std::find_if(heading.begin(), heading.end(), [&](char c) {
    const bool is_ascii = static_cast<unsigned char>(c) < 0x80;
    return is_ascii && std::isalnum(static_cast<unsigned char>(c)) == 0 && kPlain.find(c) == kPlain.npos;
  });
  return at == heading.end() ? std::string_view()
                             : heading.substr(static_cast<std::size_t>(at - heading.begin()), 1);
}

}  // namespace

std::string folded_heading(std::string_view text) {
  std::string out;
  std::size_t at = 0;
  while (at < text.size()) {
    const auto rest = text.substr(at);
    bool bracket = false;
    for (std::size_t i = 0; i < std::size(kOpening); ++i) {
      if (!rest.starts_with(kOpening[i])) continue;
      const auto end = rest.find(kClosing[i]);
      if (end == std::string_view::npos || out.empty()) continue;
      at += end + kClosing[i].size();
      bracket = true;
      break;
    }
    if (bracket) continue;
    const auto one = decode_utf8(rest);
    const bool is_word = (one.size > 1 && !rest.starts_with("　") && !rest.starts_with("\xEF\xBB\xBF") &&
                          !rest.starts_with("：")) ||
                         (rest[0] >= '0' && rest[0] <= '9') ||
                         (lower(rest.substr(0, 1))[0] >= 'a' && lower(rest.substr(0, 1))[0] <= 'z');
    if (is_word) out += lower(rest.substr(0, one.size));
    at += one.size;
  }
  return out;
}

ForeignTable::ForeignTable(std::string_view bytes, std::string_view file, std::span<const Heading> headings,
                           std::vector<Error>& errors) {
  if (bytes.starts_with("PK\x03\x04") || bytes.starts_with("\xD0\xCF\x11\xE0")) {
    errors.push_back(make_error(Errc::file, message("{} is a spreadsheet, and no text", as_it_is(file)),
                                "save the sheet with the table as CSV, and name that file"));
    return;
  }
  const auto decoded = od::to_utf8(bytes);
  const auto text = with_line_feeds(decoded.text(bytes));
  const auto found = find_headings(text, headings);
  if (!found) {
    std::string known;
    constexpr std::size_t kShown = 4;
    for (const auto& heading : headings.first(std::min(headings.size(), kShown)))
      append(known, formatted("'{}'", heading.exact.front()));
    errors.push_back(
        file_error(file, 1, "no line with column headings was found",
                   message("a table begins with a line of headings, such as {}", as_it_is(known))));
    return;
  }
  // Titles above the headings count as lines and are nothing else.
  heading_line_ = found->line;
  const auto lines = std::string(found->line - 1, '\n') + text.substr(found->begin);
  table_ = read_csv(lines, file, errors, found->separator, CsvRows::any_length);
  // Tables copied from several pages have their headings again on each.
  std::erase_if(table_.rows, [&](const CsvTable::Row& row) { return row.cells == table_.columns; });
  name_columns(headings, file, errors);
  check_headings(headings, file, errors);
  check_rows(file, errors);
}

void ForeignTable::name_columns(std::span<const Heading> headings, std::string_view file,
                                std::vector<Error>& errors) {
  names_.assign(table_.columns.size(), {});
  const auto take = [&](const auto means, bool only) {
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (!names_[i].empty()) continue;
      for (const auto& one : headings) {
        if (!means(table_.columns[i], one)) continue;
        if (!has(one.column)) {
          names_[i] = one.column;
          break;
        }
        if (!only) continue;
        errors.push_back(
            file_error(file, heading_line_,
                       message("'{}' and '{}' are headings of one column, {}", as_it_is(heading(one.column)),
                               as_it_is(table_.columns[i]), as_it_is(one.column)),
                       "keep one of the two columns"));
        break;
      }
    }
  };
  take(means_exactly, true);
  take(means_loosely, false);
  for (std::size_t i = 0; i < names_.size(); ++i)
    if (names_[i].empty() && !trim(table_.columns[i]).empty()) unknown_.push_back(table_.columns[i]);
}

/// Nothing that a heading says of the numbers below it is dropped.
void ForeignTable::check_headings(std::span<const Heading> headings, std::string_view file,
                                  std::vector<Error>& errors) const {
  for (std::size_t i = 0; i < names_.size(); ++i) {
    const std::string_view text = table_.columns[i];
    const bool number = std::any_of(headings.begin(), headings.end(), [&](const Heading& one) {
      return one.number && !names_[i].empty() && one.column == names_[i];
    });
    if (names_base(text))
      errors.push_back(file_error(
          file, heading_line_,
          message("'{}': the base of numbers is not read from a heading", as_it_is(text)),
          "write hexadecimal numbers as 0x1F, decimal ones without a prefix, and take the base out of the "
          "heading"));
    else if (number && has_bracket(text) && !is_harmless(text))
      errors.push_back(file_error(file, heading_line_,
                                  message("'{}': text in brackets over numbers is not read", as_it_is(text)),
                                  "take it out of the heading; write units into a column 'unit'"));
    else if (const auto mark = unread_mark(text); number && !mark.empty())
      errors.push_back(
          file_error(file, heading_line_,
                     message("'{}': the mark {} over numbers is not read", as_it_is(text), as_it_is(mark)),
                     "take it out of the heading; write units into a column 'unit'"));
  }
}

/// Rows that end early are filled up; no cell beyond the headings may say anything.
void ForeignTable::check_rows(std::string_view file, std::vector<Error>& errors) {
  std::size_t filled_rows = 0;
  for (auto& row : table_.rows) {
    if (filled(row) > 0) ++filled_rows;
    auto used = row.cells.size();
    while (used > 0 && trim(row.cells[used - 1]).empty()) --used;
    if (used > names_.size())
      errors.push_back(
          file_error(file, row.line, message("{} cells, {} headings", used, names_.size()),
                     "give each column a heading; put a cell that holds the separator in quotes"));
    row.cells.resize(names_.size());
    for (std::size_t i = 0; i < names_.size(); ++i)
      if (trim(table_.columns[i]).empty() && !trim(row.cells[i]).empty())
        errors.push_back(file_error(file, row.line,
                                    message("column {} has no heading: '{}'", i + 1, as_it_is(row.cells[i])),
                                    "give the column a heading, or remove it"));
  }
  if (filled_rows == 0)
    errors.push_back(file_error(file, heading_line_, "there are no rows below the headings",
                                "write one row for each parameter or fault"));
}

std::string ForeignTable::heading(std::string_view column) const {
  const auto at = place(column);
  return at ? table_.columns[*at] : std::string();
}

std::optional<std::size_t> ForeignTable::place(std::string_view column) const {
  const auto found = std::find(names_.begin(), names_.end(), column);
  return found == names_.end() ? std::nullopt : std::optional<std::size_t>(found - names_.begin());
}

std::string ForeignTable::cell(const CsvTable::Row& row, std::string_view column) const {
  const auto at = place(column);
  if (!at) return {};
  std::string out(trim(row.cells[*at]));
  std::replace_if(
      out.begin(), out.end(), [](char c) { return c == '\n' || c == '\r' || c == '\t'; }, ' ');
  return std::find(std::begin(kNothing), std::end(kNothing), out) == std::end(kNothing) ? out : std::string();
}

std::size_t ForeignTable::filled(const CsvTable::Row& row) {
  return static_cast<std::size_t>(std::count_if(row.cells.begin(), row.cells.end(),
                                                [](const auto& cell) { return !trim(cell).empty(); }));
}

bool ForeignTable::counts_rows(std::string_view column) const {
  std::size_t count = 0;
  for (const auto& row : table_.rows) {
    if (filled(row) == 0 || is_title(row)) continue;
    if (cell(row, column) != formatted("{}", ++count)) return false;
  }
  return count > 0;
}

void ForeignTable::finish(std::string_view file, std::size_t first_error, std::vector<Error>& errors,
                          ConvertedTable& out) const {
  std::stable_sort(errors.begin() + static_cast<std::ptrdiff_t>(first_error), errors.end(),
                   [](const Error& a, const Error& b) { return a.line.value_or(0) < b.line.value_or(0); });
  for (const auto& heading : unknown_)
    out.notices.push_back(message("{}:{}: column '{}' is not understood and left out", as_it_is(file),
                                  heading_line_, as_it_is(heading)));
}

bool ForeignTable::is_title(const CsvTable::Row& row) {
  return filled(row) == 1 && !row.cells.empty() && !trim(row.cells.front()).empty();
}

}  // namespace servoctl::drive
