#include "can/candump.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <string>
#include <utility>

#include "base/number.hpp"
#include "base/text.hpp"

namespace servoctl::can {
namespace {

using std::chrono::microseconds;

constexpr std::uint32_t kReportFlag = 0x2000'0000;

/// Words of a line one after the other.
class WordCursor {
 public:
  explicit WordCursor(std::string_view line) : rest_(trim(line)) {}
  std::string_view next() {
    const auto end = std::min(rest_.find(' '), rest_.size());
    const auto out = rest_.substr(0, end);
    rest_ = trim(rest_.substr(end));
    return out;
  }
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
};

std::optional<std::uint64_t> digits(std::string_view text, std::size_t most) {
  return text.empty() || text.size() > most ? std::nullopt : parse_digits(text, 10);
}

/// `1736412345.123456`: one to nine digits behind the point.
std::optional<Duration> seconds_of(std::string_view text) {
  const auto point = text.find('.');
  if (point == std::string_view::npos) return std::nullopt;
  const auto whole = digits(text.substr(0, point), 12);
  const auto behind = text.substr(point + 1);
  auto fraction = digits(behind, 9);
  if (!whole || !fraction) return std::nullopt;
  for (std::size_t i = behind.size(); i < 9; ++i) *fraction *= 10;
  return microseconds(static_cast<std::int64_t>(*whole * 1'000'000 + *fraction / 1000));
}

/// `2026-01-09 08:45:45.123456`
std::optional<Duration> date_of(std::string_view date, std::string_view time) {
  if (date.size() != 10 || date[4] != '-' || date[7] != '-' || time.size() < 10 || time[2] != ':' ||
      time[5] != ':')
    return std::nullopt;
  const auto year = digits(date.substr(0, 4), 4);
  const auto month = digits(date.substr(5, 2), 2);
  const auto day = digits(date.substr(8, 2), 2);
  const auto hour = digits(time.substr(0, 2), 2);
  const auto minute = digits(time.substr(3, 2), 2);
  const auto second = seconds_of(time.substr(6));
  if (!year || !month || !day || !hour || !minute || !second) return std::nullopt;
  const std::chrono::year_month_day calendar(std::chrono::year(static_cast<int>(*year)),
                                             std::chrono::month(static_cast<unsigned>(*month)),
                                             std::chrono::day(static_cast<unsigned>(*day)));
  if (!calendar.ok()) return std::nullopt;
  return std::chrono::sys_days(calendar).time_since_epoch() +
         std::chrono::hours(static_cast<std::int64_t>(*hour)) +
         std::chrono::minutes(static_cast<std::int64_t>(*minute)) + *second;
}

/// Takes `(…)`, if the line begins so; false when it is no time.
bool take_time(WordCursor& words, std::string_view& word, Duration& out) {
  word = words.next();
  if (!word.starts_with('(')) return true;
  std::optional<Duration> time;
  if (word.ends_with(')')) {
    time = seconds_of(word.substr(1, word.size() - 2));
  } else {
    const auto clock = words.next();
    if (clock.ends_with(')')) time = date_of(word.substr(1), clock.substr(0, clock.size() - 1));
  }
  if (!time) return false;
  out = *time;
  word = words.next();
  return true;
}

bool take_id(std::string_view text, Frame& out) {
  const auto id = text.size() == 3 || text.size() == 8 ? parse_digits(text, 16) : std::nullopt;
  if (!id) return false;
  auto number = static_cast<std::uint32_t>(*id);
  out.error = text.size() == 8 && (number & kReportFlag) != 0;
  out.extended = text.size() == 8 && !out.error;
  if (out.error) number &= ~kReportFlag;
  out.id = number;
  return number <= (text.size() == 8 ? 0x1FFF'FFFFU : 0x7FFU);
}

bool take_data(WordCursor& words, Frame& out) {
  if (words.rest().starts_with("remote request")) {
    out.remote = true;
    return true;
  }
  for (std::size_t i = 0; i < out.size; ++i) {
    const auto word = words.next();
    const auto byte = word.size() == 2 ? parse_digits(word, 16) : std::nullopt;
    if (!byte) return false;
    out.data[i] = static_cast<std::uint8_t>(*byte);
  }
  // More bytes than were announced are no remark.
  const auto next = words.next();
  return next.size() != 2 || !parse_digits(next, 16);
}

/// The frame of `cansend can0 601#40.41.60.00`, wherever in a line of a shell it stands.
std::optional<LogFrame> parse_cansend(std::string_view line) {
  constexpr std::string_view kCommand = "cansend";
  line = line.substr(0, line.find(" #"));
  const auto at = line.find(kCommand);
  // Of two on a line neither is left out.
  if (at == std::string_view::npos || line.rfind(kCommand) != at) return std::nullopt;
  WordCursor words(line.substr(at + kCommand.size()));
  LogFrame out;
  out.interface_name = words.next();
  std::string text;
  for (const char c : words.next())
    if (c == ';')
      break;
    else if (c != '.')
      text += c;
  const auto frame = parse_frame(text);
  if (!frame || out.interface_name.empty()) return std::nullopt;
  out.frame = *frame;
  return out;
}

}  // namespace

std::optional<LogFrame> parse_candump_line(std::string_view line) {
  WordCursor words(line);
  LogFrame out;
  std::string_view interface_name;
  if (!take_time(words, interface_name, out.time) || interface_name.empty()) return std::nullopt;
  out.interface_name = interface_name;
  auto word = words.next();
  if (word == "RX" || word == "TX") {
    words.next();
    words.next();
    word = words.next();
  }
  if (!take_id(word, out.frame)) return std::nullopt;
  const auto length = words.next();
  if (length.size() != 3 || length[0] != '[' || length[2] != ']' || length[1] < '0' || length[1] > '8')
    return std::nullopt;
  out.frame.size = static_cast<std::uint8_t>(length[1] - '0');
  if (!take_data(words, out.frame)) return std::nullopt;
  return out;
}

AscLine read_candump(std::string_view line) {
  if (auto logged = parse_log_line(line)) return {AscLine::Kind::frame, std::move(*logged)};
  if (auto shown = parse_candump_line(line)) return {AscLine::Kind::frame, std::move(*shown)};
  const auto text = trim(line);
  if (text.empty() || text.starts_with('#') || text.starts_with("//")) return {};
  if (line.starts_with('\t') && text.find('{') != std::string_view::npos) return {};
  if (auto sent = parse_cansend(text)) return {AscLine::Kind::frame, std::move(*sent)};
  // A remark behind a line of -L.
  if (const auto remark = text.find(" #"); remark != std::string_view::npos)
    if (auto logged = parse_log_line(text.substr(0, remark)))
      return {AscLine::Kind::frame, std::move(*logged)};
  return {is_candump_fd(line) ? AscLine::Kind::unsuited : AscLine::Kind::malformed, {}};
}

bool is_candump_fd(std::string_view line) {
  if (line.find("##") != std::string_view::npos) return true;
  const auto open = line.find('[');
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  return open != std::string_view::npos && open + 3 < line.size() && is_digit(line[open + 1]) &&
         is_digit(line[open + 2]) && line[open + 3] == ']';
}

}  // namespace servoctl::can
