#include "can/asc.hpp"

#include <linux/can/error.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "can/log_fields.hpp"

namespace servoctl::can {
namespace {

using Kind = AscLine::Kind;

/// No measurement lasts a century; a sum of times ends here.
constexpr Duration kLongest = std::chrono::hours(24 * 36525);

/// Takes the next word off the text; empty at its end.
std::string_view take_word(std::string_view& text) {
  constexpr std::string_view kBlank = " \t\r\n";
  text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size()));
  const auto word = text.substr(0, text.find_first_of(kBlank));
  text.remove_prefix(word.size());
  return word;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// `12.345678`, in seconds; a point must be there.
std::optional<Duration> parse_seconds(std::string_view text) {
  const auto point = text.find('.');
  if (point == std::string_view::npos || point > 9) return std::nullopt;
  const auto seconds = parse_digits(text.substr(0, point), 10);
  auto behind = text.substr(point + 1);
  if (behind.size() > 9) return std::nullopt;
  auto fraction = parse_digits(behind, 10);
  if (!seconds || !fraction) return std::nullopt;
  for (auto i = behind.size(); i < 9; ++i) *fraction *= 10;
  return Duration(static_cast<std::int64_t>(*seconds * 1'000'000 + *fraction / 1000));
}

/// `601`, `18EBFF00x` for 29 bits.
bool read_identifier(std::string_view text, unsigned base, Frame& out) {
  out.extended = !text.empty() && (text.back() == 'x' || text.back() == 'X');
  if (out.extended) text.remove_suffix(1);
  const auto id = parse_digits(text, base);
  if (!id || *id > (out.extended ? 0x1FFF'FFFFU : 0x7FFU)) return false;
  out.id = static_cast<std::uint32_t>(*id);
  return true;
}

/// Length and data behind `d`, length behind `r`; the length is written in hexadecimal whatever the base.
bool read_payload(std::string_view kind, std::string_view rest, unsigned base, Frame& out) {
  out.remote = equals_nocase(kind, "r");
  if (!out.remote && !equals_nocase(kind, "d")) return false;
  const auto length = take_word(rest);
  const auto size = parse_digits(length, 16);
  if (out.remote && !size) return true;  // Older logs do not tell what was asked for.
  if (!size || *size > 15) return false;
  out.size = static_cast<std::uint8_t>(std::min<std::uint64_t>(*size, out.data.size()));
  if (out.remote) return true;
  for (std::size_t i = 0; i < out.size; ++i) {
    const auto byte = parse_digits(take_word(rest), base);
    if (!byte || *byte > 0xFF) return false;
    out.data[i] = static_cast<std::uint8_t>(*byte);
  }
  return true;
}

Frame error_frame() {
  Frame out;
  out.error = true;
  out.id = CAN_ERR_PROT;
  out.size = CAN_ERR_DLC;
  return out;
}

/// `Sat Nov 21 10:00:00.000 am 2026`
std::optional<Duration> parse_asc_date(std::string_view text) {
  constexpr std::string_view kMonths[] = {"jan", "feb", "mar", "apr", "may", "jun",
                                          "jul", "aug", "sep", "oct", "nov", "dec"};
  constexpr std::string_view kGerman[] = {"jan", "feb", "mär", "apr", "mai", "jun",
                                          "jul", "aug", "sep", "okt", "nov", "dez"};
  (void)take_word(text);
  const auto name = lower(take_word(text));
  std::size_t month = 0;
  for (std::size_t i = 0; i < std::size(kMonths); ++i)
    if (name == kMonths[i] || name == kGerman[i]) month = i + 1;
  const auto day = take_word(text);
  std::string time(take_word(text));
  auto year = take_word(text);
  if (equals_nocase(year, "am") || equals_nocase(year, "pm")) {
    time += ' ' + std::string(year);
    year = take_word(text);
  }
  const auto date = parse_log_date(formatted("{}.{}.{}", day, month, year));
  const auto clock = parse_log_time(time, TimeUnit::seconds);
  if (!date || !clock || clock->kind != LogTime::Kind::day) return std::nullopt;
  return *date + clock->value;
}

/// Bus systems whose lines begin with their name instead of a channel.
bool is_foreign(std::string_view word) {
  constexpr std::string_view kOthers[] = {"CANFD", "LIN", "FR", "ETH", "MOST", "J1939TP", "A429"};
  return std::any_of(std::begin(kOthers), std::end(kOthers),
                     [word](std::string_view other) { return equals_nocase(word, other); });
}

}  // namespace

AscLine AscReader::read(std::string_view line) {
  auto rest = line;
  const auto first = take_word(rest);
  if (first.empty() || !is_digit(first.front())) {
    if (equals_nocase(first, "base")) {
      base_ = equals_nocase(take_word(rest), "dec") ? 10 : 16;
      if (equals_nocase(take_word(rest), "timestamps"))
        relative_ = equals_nocase(take_word(rest), "relative");
    } else if (equals_nocase(first, "date")) {
      if (const auto date = parse_asc_date(rest)) clock_ = {LogClock::Kind::local, *date};
    }
    return {};
  }
  const auto time = parse_seconds(first);
  if (!time) return {Kind::malformed};
  // Events that are no frames count as well: the next relative time begins there.
  time_ = std::min(relative_ ? time_ + *time : *time, kLongest);
  return read_event(time_, rest);
}

AscLine AscReader::read_event(Duration time, std::string_view rest) const {
  const auto channel = take_word(rest);
  if (is_foreign(channel)) return {Kind::unsuited};
  if (!parse_digits(channel, 10)) return {};  // `Start of measurement`, `CAN 1 Status:…`
  AscLine out{Kind::frame, {time, "can" + std::string(channel), {}}};
  const auto identifier = take_word(rest);
  if (equals_nocase(identifier, "ErrorFrame")) {
    out.frame.frame = error_frame();
    return out;
  }
  const auto direction = take_word(rest);
  if (equals_nocase(direction, "TxRq")) return {};  // Asked for, not yet on the bus.
  const bool has_identifier = read_identifier(identifier, base_, out.frame.frame);
  const bool has_direction = equals_nocase(direction, "Rx") || equals_nocase(direction, "Tx");
  if (!has_identifier && !has_direction) return {};  // `1 Statistic: …`
  if (!has_identifier || !has_direction) return {Kind::malformed};
  if (!read_payload(take_word(rest), rest, base_, out.frame.frame)) return {Kind::malformed};
  return out;
}

bool is_asc(std::string_view beginning) {
  constexpr std::size_t kMostLines = 20;
  for (std::size_t i = 0; i < kMostLines && !beginning.empty(); ++i) {
    const auto end = beginning.find('\n');
    auto line = beginning.substr(0, end);
    beginning.remove_prefix(end == std::string_view::npos ? beginning.size() : end + 1);
    const auto word = take_word(line);
    const auto second = take_word(line);
    if (equals_nocase(word, "base") && (equals_nocase(second, "hex") || equals_nocase(second, "dec")))
      return true;
  }
  return false;
}

}  // namespace servoctl::can
