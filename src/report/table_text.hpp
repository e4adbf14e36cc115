#pragma once

#include <cstddef>
#include <string>

#include "base/printable.hpp"
#include "report/line.hpp"
#include "report/value.hpp"

namespace servoctl::report {

constexpr std::size_t kColumnGap = 2;

/// A line for a place where a line break would spoil the layout.
inline std::string cell_text(const Value& value) { return printable(line_text(value)); }

/// A heading, as it is shown.
template <class T>
std::string title_of(const T& named) {
  return printable(named.title.empty() ? named.key : named.title);
}

/// The rows in at most `width` columns (0: no limit). Cells are broken at blanks alone, so that no number,
/// path or name is cut. Where the longest words of all columns do not fit beside each other each row is a
/// block with a line for each cell. Nothing is left out.
std::string table_text(const Table& table, std::size_t width);

/// Columns that the others, as wide as they are, leave for this one; npos where the width is 0.
std::size_t room_for(const Table& table, std::size_t column, std::size_t width);

}  // namespace servoctl::report
