#include "can/log_fields.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <string>

#include "base/number.hpp"
#include "base/text.hpp"

namespace servoctl::can {
namespace {

constexpr std::string_view kDecimals = "0123456789";
/// No recording lasts longer, or lies so far from 1970.
constexpr std::int64_t kMostSeconds = 100'000'000'000;

bool all_of(std::string_view text, std::string_view set) {
  return !text.empty() && text.find_first_not_of(set) == std::string_view::npos;
}

/// The digits behind the point in units of a millionth, further ones left out.
std::int64_t millionths(std::string_view digits) {
  std::int64_t out = 0;
  for (std::size_t i = 0; i < 6; ++i) out = out * 10 + (i < digits.size() ? digits[i] - '0' : 0);
  return out;
}

/// `12.345`, `12,345`, `12`.
std::optional<LogTime> parse_count(std::string_view text, TimeUnit unit) {
  const auto point = std::min(text.find_first_of(".,"), text.size());
  const auto whole = text.substr(0, point);
  const auto behind = text.substr(std::min(point + 1, text.size()));
  if (!all_of(whole, kDecimals) || whole.size() > 17 || (point < text.size() && !all_of(behind, kDecimals)))
    return std::nullopt;
  if (unit == TimeUnit::open && point == text.size()) return std::nullopt;
  const auto number = static_cast<std::int64_t>(*parse_digits(whole, 10));
  const std::int64_t scale = unit == TimeUnit::microseconds   ? 1
                             : unit == TimeUnit::milliseconds ? 1000
                                                              : 1'000'000;
  if (number / (1'000'000 / scale) > kMostSeconds) return std::nullopt;
  return LogTime{LogTime::Kind::count, Duration(number * scale + millionths(behind) * scale / 1'000'000)};
}

/// Up to two digits off the front, behind which `end` stands or nothing.
std::optional<std::int64_t> take_part(std::string_view& text, std::string_view ends) {
  const auto size = std::min(text.find_first_of(ends), text.size());
  const auto digits = text.substr(0, size);
  if (size > 2 || !all_of(digits, kDecimals)) return std::nullopt;
  text.remove_prefix(std::min(size + 1, text.size()));
  return static_cast<std::int64_t>(*parse_digits(digits, 10));
}

/// Takes ` PM` off; the hours it adds to noon.
int take_half_day(std::string_view& text, std::int64_t hour) {
  const bool pm = text.size() > 2 && equals_nocase(text.substr(text.size() - 2), "pm");
  const bool am = text.size() > 2 && equals_nocase(text.substr(text.size() - 2), "am");
  if (!am && !pm) return 0;
  text = trim(text.substr(0, text.size() - 2));
  return pm && hour < 12 ? 12 : am && hour == 12 ? -12 : 0;
}

/// `13:44:51.010`, `13:59:38:0099`, `13:59:38.123.456`.
std::optional<Duration> parse_clock(std::string_view text) {
  const auto hour = take_part(text, ":");
  const auto minute = hour ? take_part(text, ":") : std::nullopt;
  if (!minute || *hour > 23 || *minute > 59) return std::nullopt;
  const auto half = take_half_day(text, *hour);
  std::int64_t second = 0;
  if (!text.empty()) {
    const auto part = take_part(text, ".,:");
    if (!part || *part > 59) return std::nullopt;
    second = *part;
  }
  std::string fraction;
  for (const char c : text) {
    if (kDecimals.find(c) == std::string_view::npos && c != '.' && c != ':') return std::nullopt;
    if (c != '.' && c != ':') fraction += c;
  }
  return Duration((((*hour + half) * 60 + *minute) * 60 + second) * 1'000'000 + millionths(fraction));
}

struct WordMeaning {
  std::string_view word;
  bool LogWords::*says;
};
/// Whole words, in lower case.
constexpr WordMeaning kWholeWords[] = {
    {"s", &LogWords::standard},
    {"x", &LogWords::extended},
    {"r", &LogWords::remote},
    {"rr", &LogWords::remote},
    {"e", &LogWords::error},
    {"er", &LogWords::error},
    {"f", &LogWords::fd},
    {"fb", &LogWords::fd},
    {"fe", &LogWords::fd},
    {"sff", &LogWords::standard},
    {"eff", &LogWords::extended},
    {"err", &LogWords::error},
    {"r11", &LogWords::standard},
    {"t11", &LogWords::standard},
    {"r29", &LogWords::extended},
    {"t29", &LogWords::extended},
    {"11-bit", &LogWords::standard},
    {"11bit", &LogWords::standard},
    {"29-bit", &LogWords::extended},
    {"29bit", &LogWords::extended},
    {"2.0a", &LogWords::standard},
    {"can 2.0a", &LogWords::standard},
    {"2.0b", &LogWords::extended},
    {"can 2.0b", &LogWords::extended},
};
/// Parts of words; the second form of a Chinese one is that of GBK.
constexpr WordMeaning kParts[] = {
    {"std", &LogWords::standard},       {"standard", &LogWords::standard},
    {"ext", &LogWords::extended},       {"xtd", &LogWords::extended},
    {"erweitert", &LogWords::extended}, {"rtr", &LogWords::remote},
    {"remote", &LogWords::remote},      {"error", &LogWords::error},
    {"fehler", &LogWords::error},       {"fd", &LogWords::fd},
    {"标准", &LogWords::standard},      {"\xB1\xEA\xD7\xBC", &LogWords::standard},
    {"扩展", &LogWords::extended},      {"\xC0\xA9\xD5\xB9", &LogWords::extended},
    {"远程", &LogWords::remote},        {"\xD4\xB6\xB3\xCC", &LogWords::remote},
    {"错误", &LogWords::error},         {"\xB4\xED\xCE\xF3", &LogWords::error},
};
/// What says nothing of the kind: data frame, received, sent.
constexpr std::string_view kPlainWords[] = {"d",
                                            "dt",
                                            "rx",
                                            "tx",
                                            "data",
                                            "data frame",
                                            "bs",
                                            "ei",
                                            "数据",
                                            "数据帧",
                                            "\xCA\xFD\xBE\xDD\xD6\xA1",
                                            "can",
                                            "normal",
                                            "no error",
                                            "接收",
                                            "发送",
                                            "\xBD\xD3\xCA\xD5",
                                            "\xB7\xA2\xCB\xCD"};

}  // namespace

std::string_view bare_value(std::string_view text) {
  text = trim(text);
  if (text.starts_with("=\"")) text.remove_prefix(1);
  for (bool again = true; again && text.size() > 1;) {
    const char first = text.front();
    const char last = text.back();
    again = (first == '"' && last == '"') || (first == '(' && last == ')') || (first == '[' && last == ']');
    if (again) text = trim(text.substr(1, text.size() - 2));
  }
  while (!text.empty() && (text.back() == ':' || text.back() == ',' || text.back() == ';'))
    text.remove_suffix(1);
  return text;
}

std::optional<Duration> parse_log_date(std::string_view text) {
  constexpr std::string_view kEnds = ".-/";
  const auto first_end = text.find_first_of(kEnds);
  if (first_end == std::string_view::npos) return std::nullopt;
  const bool year_first = first_end == 4;
  if (!year_first && text[first_end] != '.') return std::nullopt;
  std::array<std::uint64_t, 3> part{};
  for (std::size_t i = 0; i < part.size(); ++i) {
    const auto end = std::min(text.find_first_of(kEnds), text.size());
    const auto digits = parse_digits(text.substr(0, std::min<std::size_t>(end, 5)), 10);
    if (!digits || (i == 2) != (end == text.size())) return std::nullopt;
    part[i] = *digits;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  const auto year = year_first ? part[0] : part[2];
  const auto day = year_first ? part[2] : part[0];
  if (year < 1970 || year > 2999 || part[1] > 12 || day > 31) return std::nullopt;
  const std::chrono::year_month_day date(std::chrono::year(static_cast<int>(year)),
                                         std::chrono::month(static_cast<unsigned>(part[1])),
                                         std::chrono::day(static_cast<unsigned>(day)));
  if (!date.ok()) return std::nullopt;
  return Duration(std::chrono::sys_days(date).time_since_epoch());
}

std::optional<LogTime> parse_log_time(std::string_view text, TimeUnit unit) {
  text = bare_value(text);
  const auto gap = text.size() > 10 ? text.find_first_of(" T") : std::string_view::npos;
  if (gap != std::string_view::npos && gap >= 8 && gap <= 10) {
    const auto date = parse_log_date(text.substr(0, gap));
    auto rest = trim(text.substr(gap + 1));
    if (rest.ends_with('Z')) rest.remove_suffix(1);
    const auto clock = parse_clock(rest);
    if (!date || !clock) return std::nullopt;
    return LogTime{LogTime::Kind::date, *date + *clock};
  }
  if (text.find(':') == std::string_view::npos) return parse_count(text, unit);
  const auto clock = parse_clock(text);
  return clock ? std::optional(LogTime{LogTime::Kind::day, *clock}) : std::nullopt;
}

std::optional<LogId> parse_log_id(std::string_view text) {
  text = bare_value(text);
  if (const auto sign = text.find_last_of("=:");
      sign != std::string_view::npos && text.find_first_of(kDecimals) > sign)
    text = trim(text.substr(sign + 1));
  LogId out;
  if (starts_with_nocase(text, "0x")) {
    out.base = 16;
    text = trim(text.substr(2));
  }
  if (!text.empty() && (text.back() == 'x' || text.back() == 'X')) {
    out.extended = true;
    text.remove_suffix(1);
  } else if (!text.empty() && (text.back() == 'h' || text.back() == 'H')) {
    out.base = 16;
    text.remove_suffix(1);
  }
  out.digits = text;
  const bool good = text.size() <= 10 && parse_digits(text, 16);
  return good ? std::optional(out) : std::nullopt;
}

std::optional<std::uint8_t> parse_log_byte(std::string_view text, unsigned base) {
  if (starts_with_nocase(text, "0x")) {
    base = 16;
    text.remove_prefix(2);
  }
  const auto value = text.size() > (base == 16 ? 2 : 3) ? std::nullopt : parse_digits(text, base);
  return value && *value <= 0xFF ? std::optional(static_cast<std::uint8_t>(*value)) : std::nullopt;
}

std::optional<unsigned> parse_log_length(std::string_view text) {
  text = bare_value(text);
  if (const auto sign = text.find_last_of("=:"); sign != std::string_view::npos)
    text = bare_value(text.substr(sign + 1));
  const bool hex = starts_with_nocase(text, "0x");
  if (hex) text = trim(text.substr(2));
  const auto value = text.size() > 2 ? std::nullopt : parse_digits(text, hex ? 16 : 10);
  return value && *value <= 64 ? std::optional(static_cast<unsigned>(*value)) : std::nullopt;
}

bool read_log_words(std::string_view text, LogWords& out) {
  const auto word = lower(bare_value(text));
  const auto* whole = std::find_if(std::begin(kWholeWords), std::end(kWholeWords),
                                   [&](const auto& each) { return each.word == word; });
  if (whole != std::end(kWholeWords)) {
    out.*whole->says = true;
    return true;
  }
  // Of BUSMASTER: standard or extended, and remote.
  if (word == "sr" || word == "xr") {
    (word == "sr" ? out.standard : out.extended) = out.remote = true;
    return true;
  }
  bool known = std::find(std::begin(kPlainWords), std::end(kPlainWords), word) != std::end(kPlainWords);
  for (const auto& part : kParts) {
    if (word.find(part.word) == std::string::npos) continue;
    out.*part.says = true;
    known = true;
  }
  return known;
}

bool is_direction(std::string_view text) {
  constexpr std::string_view kWords[] = {
      "rx",   "tx",   "r",   "t",   "->",  "<-", "接收", "发送", "\xBD\xD3\xCA\xD5", "\xB7\xA2\xCB\xCD",
      "recv", "send", "r11", "t11", "r29", "t29"};
  const auto word = bare_value(text);
  return std::any_of(std::begin(kWords), std::end(kWords),
                     [&](auto each) { return equals_nocase(word, each); });
}

std::optional<bool> yes_or_no(std::string_view text) {
  constexpr std::string_view kYes[] = {"1",      "t",   "true",     "y",   "yes", "x",
                                       "wahr",   "ja",  "vrai",     "oui", "r",   "rtr",
                                       "remote", "ext", "extended", "eff", "是",  "\xCA\xC7"};
  constexpr std::string_view kNo[] = {"",         "0",      "f",    "false", "n",       "no",
                                      "-",        "falsch", "nein", "faux",  "non",     "std",
                                      "standard", "sff",    "data", "否",    "\xB7\xF1"};
  const auto word = bare_value(text);
  const auto is = [&](std::string_view each) { return equals_nocase(word, each); };
  if (std::any_of(std::begin(kYes), std::end(kYes), is)) return true;
  return std::any_of(std::begin(kNo), std::end(kNo), is) ? std::optional(false) : std::nullopt;
}

bool is_yes(std::string_view text) { return yes_or_no(text).value_or(false); }

}  // namespace servoctl::can
