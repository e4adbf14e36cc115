#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace servoctl {

/// A table read from comma-separated text (RFC 4180): quotes, doubled quotes and line breaks in quotes, LF or
/// CRLF, an optional UTF-8 byte order mark. The first record holds the column names.
struct CsvTable {
  struct Row {
    std::vector<std::string> cells;  ///< As many as there are columns.
    std::uint32_t line = 0;          ///< Line of the file in which the record starts, from 1.
  };
  std::vector<std::string> columns;
  std::vector<Row> rows;

  /// Position of the column, or columns.size() when there is none of this name.
  std::size_t column(std::string_view name) const;
  /// Adds an error for each of these columns that is missing; false when there is one. An empty table has
  /// none.
  bool has_columns(std::span<const std::string_view> needed, std::string_view file,
                   std::vector<Error>& errors) const;
};

/// Whether each record has a cell for every column, and each column a name of its own.
enum class CsvRows : std::uint8_t { exact, any_length };

/// Reads the whole text and adds to `errors` what is wrong in it: a record with too few or too many cells
/// (which is left out), an unclosed quote (the text ends there), a column named twice. Each is Errc::file
/// with its line. `file` is used in messages only.
CsvTable read_csv(std::string_view text, std::string_view file, std::vector<Error>& errors,
                  char separator = ',', CsvRows rows = CsvRows::exact);

/// Reads the whole text; an apostrophe that csv_cell() would have put before a cell is no part of it. `file`
/// is used in messages only. A record with too few or too many cells, an unclosed quote or a column named
/// twice is an error of Errc::file with its line; the first is returned.
Result<CsvTable> parse_csv(std::string_view text, std::string_view file);

/// A cell as parse_csv() reads it: in quotes where it holds a comma, a quote or a line break. What a
/// spreadsheet would take for a formula (a text, not a number, that begins with `=`, `+`, `-` or `@`, perhaps
/// behind blanks or apostrophes, and one that begins with a tab or a line break) is written with an
/// apostrophe before it, which parse_csv() takes away: `=1+1` is `'=1+1`, `'=x` is `''=x`, `-5` is `-5`.
std::string csv_cell(std::string_view text);

/// The cell over a column of numbers: `velocity (rpm)`, or the name alone where there is no unit.
std::string csv_heading(std::string_view name, std::string_view unit);

}  // namespace servoctl
