#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "can/asc.hpp"
#include "can/log_fields.hpp"

namespace servoctl::can {

/// The cells of a line of a log by what they are; those that it lacks are empty.
struct LogCells {
  std::string_view time;
  std::string_view fraction;  ///< Of the second, in ms: `010.250` is 10 ms and 250 us.
  std::string_view date;
  std::string_view id;
  std::string_view decimal_id;  ///< The same identifier once more, in decimal.
  std::string_view length;
  std::string_view channel;
  std::string_view extended;  ///< A cell that says yes or no.
  std::string_view remote;    ///< As `extended`.
  std::string_view error;     ///< As `extended`.
  std::string_view fd;        ///< As `extended`.
  LogWords words;
  std::vector<std::string_view> data;  ///< A byte each, or all of them in one.
  bool data_by_byte = false;           ///< A column for each byte: more of them than are sent.

  void clear();
};

/// How the numbers of a log are written.
struct LogNumbers {
  unsigned id_base = 0;    ///< 10 or 16; 0: not known.
  unsigned data_base = 0;  ///< As `id_base`.
  TimeUnit unit = TimeUnit::open;
  bool relative = false;  ///< Times count from the line before.
  bool base64 = false;    ///< The data are.
  bool operator==(const LogNumbers&) const = default;
};

/// Makes frames of cells, line after line.
class LogRow {
 public:
  /// Its cells have to be in front of the call; a frame, a CAN FD frame, or malformed.
  AscLine read(const LogCells& cells, const LogNumbers& numbers);
  const LogClock& clock() const { return clock_; }
  /// The day of the first time of day.
  void set_day(Duration since_1970) { day_ = since_1970; }
  /// A line had an integer for a time, and nothing says its unit.
  bool lacks_unit() const { return lacks_unit_; }

 private:
  bool read_time(const LogCells& cells, const LogNumbers& numbers);
  void take_day(Duration time);

  Duration time_{};
  Duration midnights_{};  ///< Passed since the first line.
  Duration day_{};        ///< Since 1970; zero: not known.
  LogClock clock_;
  bool lacks_unit_ = false;
  std::vector<std::uint8_t> bytes_;
};

/// What tells decimal numbers from hexadecimal ones, gathered from lines.
class BaseEvidence {
 public:
  void add(const LogCells& cells);
  /// Fills what of `numbers` is open as far as the lines tell it.
  void settle(LogNumbers& numbers) const;
  /// The base of the identifiers follows from the data alone.
  bool assumed(const LogNumbers& before) const;
  /// That of the data follows from the identifiers alone.
  bool assumed_data(const LogNumbers& before) const;

 private:
  void add_id(std::string_view text);
  void add_data(std::string_view text);

  bool id_open_ = false;          ///< Identifiers without `0x` or `h`.
  bool id_hex_ = false;           ///< A letter, or zeros in front.
  bool id_over_ = false;          ///< One that as hexadecimal has more than 11 bits and four digits at most.
  bool id_over_decimal_ = false;  ///< One that as decimal has more than 11 bits.
  bool data_hex_ = false;         ///< A letter, `00` to `09`, or bytes without blanks.
  bool data_decimal_ = false;     ///< Three digits.
  bool data_open_ = false;
};

}  // namespace servoctl::can
