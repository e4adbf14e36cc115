#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "base/time.hpp"
#include "can/asc.hpp"

namespace servoctl::can {

/// Reads PEAK trace files (.trc, versions 1.0 to 2.1), line by line:
///
///          1)      1841  0601  8  40 41 60 00 00 00 00 00
///          1      17535.400 DT 1      0601 Rx -  8    40 41 60 00 00 00 00 00
///
/// What stands in which column is told by `;$FILEVERSION`, from 2.0 on by `;$COLUMNS`; without either it is
/// 1.0. Bus 2 becomes `can2`; without a column for it the name is `can1`. Times count from the beginning of
/// the trace. Error frames become those of AscReader; warnings and states of the hardware are remarks, CAN FD
/// frames and those with more than 8 bytes are unsuited.
class TrcReader {
 public:
  TrcReader();
  AscLine read(std::string_view line);
  /// By `;$STARTTIME`.
  LogClock clock() const { return clock_; }

 private:
  void read_header(std::string_view line);
  AscLine read_event(const std::vector<std::string_view>& words) const;

  LogClock clock_;
  std::vector<char> order_;  ///< Of the columns, by the letters of `;$COLUMNS`.
};

/// Whether a file that begins like this is a .trc trace.
bool is_trc(std::string_view beginning);

}  // namespace servoctl::can
