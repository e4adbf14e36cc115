#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "can/log_row.hpp"

namespace servoctl::can {

/// What a column of a log holds.
enum class LogRole : std::uint8_t {
  skip,
  time,
  date,
  id,
  decimal_id,
  length,
  data,   ///< All bytes.
  byte,   ///< One of them.
  words,  ///< Kind of frame, direction, and what is said in words.
  channel,
  extended,
  remote,
  error,
  fd,
};

/// The columns of a log whose lines are split at one character.
struct LogColumns {
  char separator = ',';  ///< A blank stands for any number of blanks and tabs.
  std::vector<LogRole> roles;
  LogNumbers numbers;
  /// Which byte each column of one holds, from 0; empty: in the order of the columns.
  std::vector<std::size_t> bytes;

  bool has(LogRole role) const;
  bool operator==(const LogColumns&) const = default;
};

/// The cells of a line; quotes stay, and a separator in quotes does not count.
void split_cells(std::string_view line, char separator, std::vector<std::string_view>& out);

/// The columns that a line names, in English, German or Chinese: `Time (abs)`, `ID (hex)`, `帧ID`. Empty
/// where they name no identifier or no data, or not which byte is which.
std::optional<LogColumns> read_column_names(std::string_view line);

/// Whether a line names columns, even if these are no columns of frames.
bool names_columns(std::string_view line);

/// Puts the cells of a line where they belong; false where the line has too few of them for a frame.
bool place_cells(const LogColumns& columns, const std::vector<std::string_view>& cells, LogCells& out);

}  // namespace servoctl::can
