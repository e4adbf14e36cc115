#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "base/time.hpp"
#include "can/frame.hpp"

/// What stands in one place of a line of a log: times, identifiers, bytes, words.
namespace servoctl::can {

enum class TimeUnit : std::uint8_t { open, seconds, milliseconds, microseconds };

struct LogTime {
  enum class Kind : std::uint8_t {
    count,  ///< Since something, such as the beginning of the recording.
    day,    ///< Time of day.
    date,   ///< Since 1970, of a date and a time of day.
  };
  Kind kind = Kind::count;
  Duration value{};
};

/// Takes what tools put around a value off it: blanks, `"…"`, `="…"`, `(…)`, `[…]`, a colon or comma behind.
std::string_view bare_value(std::string_view text);

/// Reads `12.345678`, `1234` of a unit that is known, `13:44:51.010`, `13:59:38:0099` (a fraction in digits),
/// `1:59:38.5 PM`, `2026-11-21 13:59:35.1`, `21.11.2026 13:59`. Empty for anything else, and for an integer
/// whose unit is open; a date with `/` is not read, as nobody can tell day and month apart.
std::optional<LogTime> parse_log_time(std::string_view text, TimeUnit unit);

/// The day of `2026-11-21` or `21.11.2026`, `2026/11/21`, since 1970.
std::optional<Duration> parse_log_date(std::string_view text);

/// An identifier, as it is written.
struct LogId {
  std::string_view digits;
  unsigned base = 0;      ///< Told by `0x` or `h`; 0 where it is not.
  bool extended = false;  ///< An `x` behind it.
};
/// `601`, `0x601`, `601h`, `18EBFF00x`, `0x 0601`, `ID=601`; at most 10 digits.
std::optional<LogId> parse_log_id(std::string_view text);

/// A byte of two digits at most (hexadecimal), three (decimal).
std::optional<std::uint8_t> parse_log_byte(std::string_view text, unsigned base);

/// `8`, `[8]`, `0x08`, `DLC=8`; at most 64.
std::optional<unsigned> parse_log_length(std::string_view text);

/// What a word says of the frame beside it.
struct LogWords {
  bool standard = false;
  bool extended = false;
  bool remote = false;
  bool error = false;
  bool fd = false;
  bool unknown = false;  ///< A word in a column of them that says nothing known.
};
/// `x`, `Std`, `sr`, `Remote frame`, `扩展帧`, also in GBK; adds to `out`. False for a word that says
/// nothing.
bool read_log_words(std::string_view text, LogWords& out);

/// Whether a word is a direction: `Rx`, `TX`, `接收`, `->`.
bool is_direction(std::string_view text);

/// `1`, `T`, `true`, `ja`, `是`, or `0`, `F`, `-`, `否` and nothing at all; empty for what is neither.
std::optional<bool> yes_or_no(std::string_view text);
bool is_yes(std::string_view text);

}  // namespace servoctl::can
