#pragma once

#include <cstdint>
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
};

/// Reads the whole text. `file` is used in messages only. A record with too few or too many cells, an
/// unclosed quote or a column named twice is an error of Errc::file with its line.
Result<CsvTable> parse_csv(std::string_view text, std::string_view file);

/// A cell as parse_csv() reads it: in quotes where it holds a comma, a quote or a line break.
std::string csv_cell(std::string_view text);

}  // namespace servoctl
