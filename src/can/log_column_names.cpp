#include "can/log_column_names.hpp"

#include <algorithm>
#include <utility>

#include "base/text.hpp"
#include "can/log_fields.hpp"

namespace servoctl::can {
namespace {

struct ColumnName {
  LogRole role;
  std::string_view name;
};
/// In lower case, without blanks and marks; after each Chinese name its form in GBK.
constexpr ColumnName kColumnNames[] = {
    {LogRole::time, "time"},
    {LogRole::time, "timestamp"},
    {LogRole::time, "abstime"},
    {LogRole::time, "systemtime"},
    {LogRole::time, "timeidentifier"},
    {LogRole::time, "zeit"},
    {LogRole::time, "zeitstempel"},
    {LogRole::time, "uhrzeit"},
    {LogRole::time, "t"},
    {LogRole::time, "时间"},
    {LogRole::time, "\xCA\xB1\xBC\xE4"},
    {LogRole::time, "系统时间"},
    {LogRole::time, "\xCF\xB5\xCD\xB3\xCA\xB1\xBC\xE4"},
    {LogRole::time, "时间标识"},
    {LogRole::time, "\xCA\xB1\xBC\xE4\xB1\xEA\xCA\xB6"},
    {LogRole::time, "时间戳"},
    {LogRole::time, "\xCA\xB1\xBC\xE4\xB4\xC1"},
    {LogRole::time, "接收时间"},
    {LogRole::time, "\xBD\xD3\xCA\xD5\xCA\xB1\xBC\xE4"},
    {LogRole::date, "date"},
    {LogRole::date, "datum"},
    {LogRole::date, "日期"},
    {LogRole::date, "\xC8\xD5\xC6\xDA"},
    {LogRole::id, "id"},
    {LogRole::id, "canid"},
    {LogRole::id, "arbid"},
    {LogRole::id, "arbitrationid"},
    {LogRole::id, "identifier"},
    {LogRole::id, "ident"},
    {LogRole::id, "identifikator"},
    {LogRole::id, "msgid"},
    {LogRole::id, "messageid"},
    {LogRole::id, "frameid"},
    {LogRole::id, "cobid"},
    {LogRole::id, "nachrichtenid"},
    {LogRole::id, "帧id"},
    {LogRole::id, "\xD6\xA1id"},
    {LogRole::id, "id号"},
    {LogRole::id, "id\xBA\xC5"},
    {LogRole::id, "标识符"},
    {LogRole::id, "\xB1\xEA\xCA\xB6\xB7\xFB"},
    {LogRole::length, "dlc"},
    {LogRole::length, "len"},
    {LogRole::length, "length"},
    {LogRole::length, "datalength"},
    {LogRole::length, "dl"},
    {LogRole::length, "laenge"},
    {LogRole::length, "länge"},
    {LogRole::length, "l\xE4nge"},
    {LogRole::length, "datenlänge"},
    {LogRole::length, "长度"},
    {LogRole::length, "\xB3\xA4\xB6\xC8"},
    {LogRole::length, "帧长度"},
    {LogRole::length, "\xD6\xA1\xB3\xA4\xB6\xC8"},
    {LogRole::length, "数据长度"},
    {LogRole::length, "\xCA\xFD\xBE\xDD\xB3\xA4\xB6\xC8"},
    {LogRole::data, "data"},
    {LogRole::data, "payload"},
    {LogRole::data, "databytes"},
    {LogRole::data, "daten"},
    {LogRole::data, "datenbytes"},
    {LogRole::data, "数据"},
    {LogRole::data, "\xCA\xFD\xBE\xDD"},
    {LogRole::data, "帧数据"},
    {LogRole::data, "\xD6\xA1\xCA\xFD\xBE\xDD"},
    {LogRole::words, "flags"},
    {LogRole::words, "flg"},
    {LogRole::words, "type"},
    {LogRole::words, "frametype"},
    {LogRole::words, "format"},
    {LogRole::words, "frameformat"},
    {LogRole::words, "typ"},
    {LogRole::words, "帧类型"},
    {LogRole::words, "\xD6\xA1\xC0\xE0\xD0\xCD"},
    {LogRole::words, "帧格式"},
    {LogRole::words, "\xD6\xA1\xB8\xF1\xCA\xBD"},
    {LogRole::words, "类型"},
    {LogRole::words, "\xC0\xE0\xD0\xCD"},
    {LogRole::words, "can类型"},
    {LogRole::words, "can\xC0\xE0\xD0\xCD"},
    {LogRole::words, "格式"},
    {LogRole::words, "\xB8\xF1\xCA\xBD"},
    {LogRole::channel, "bus"},
    {LogRole::channel, "channel"},
    {LogRole::channel, "canchannel"},
    {LogRole::channel, "chn"},
    {LogRole::channel, "ch"},
    {LogRole::channel, "kanal"},
    {LogRole::channel, "network"},
    {LogRole::channel, "interface"},
    {LogRole::channel, "通道"},
    {LogRole::channel, "\xCD\xA8\xB5\xC0"},
    {LogRole::channel, "通道号"},
    {LogRole::channel, "\xCD\xA8\xB5\xC0\xBA\xC5"},
    {LogRole::channel, "源通道"},
    {LogRole::channel, "\xD4\xB4\xCD\xA8\xB5\xC0"},
    {LogRole::channel, "can通道"},
    {LogRole::channel, "can\xCD\xA8\xB5\xC0"},
    {LogRole::extended, "extended"},
    {LogRole::extended, "xtd"},
    {LogRole::extended, "ext"},
    {LogRole::extended, "ide"},
    {LogRole::remote, "remote"},
    {LogRole::remote, "rtr"},
    {LogRole::error, "error"},
    {LogRole::error, "er"},
    {LogRole::error, "err"},
    {LogRole::fd, "fd"},
    {LogRole::fd, "fdf"},
    {LogRole::fd, "edl"},
    {LogRole::fd, "canfd"},
    // Known, and of no use here.
    {LogRole::skip, "state"},
    {LogRole::skip, "no"},
    {LogRole::skip, "nr"},
    {LogRole::skip, "line"},
    {LogRole::skip, "index"},
    {LogRole::skip, "number"},
    {LogRole::skip, "dir"},
    {LogRole::skip, "direction"},
    {LogRole::skip, "ascii"},
};

/// `b1`, `d0`, `data3`, `byte7`, `数据1`.
bool is_byte_name(std::string_view name) {
  constexpr std::string_view kBytes[] = {"b",        "d",  "data", "byte",
                                         "databyte", "db", "数据", "\xCA\xFD\xBE\xDD"};
  if (name.empty() || name.back() < '0' || name.back() > '8') return false;
  name.remove_suffix(1);
  return std::find(std::begin(kBytes), std::end(kBytes), name) != std::end(kBytes);
}

}  // namespace

HeaderName header_name(std::string_view cell) {
  HeaderName out;
  constexpr std::string_view kWide = "（";
  constexpr std::string_view kWideEnd = "）";
  std::string text = lower(bare_value(cell));
  for (const auto& [from, to] : {std::pair(kWide, '('), std::pair(kWideEnd, ')')})
    for (auto at = text.find(from); at != std::string::npos; at = text.find(from))
      text.replace(at, from.size(), 1, to);
  bool inside = false;
  for (const char c : text) {
    if (c == '(' || c == '[') inside = true;
    const bool mark = std::string_view(" ()[]_-.#\"'\t").find(c) != std::string_view::npos;
    if (!mark) (inside ? out.qualifier : out.name) += c;
  }
  return out;
}

std::optional<LogRole> role_of_name(std::string_view name) {
  if (is_byte_name(name)) return LogRole::byte;
  const auto find = [](std::string_view wanted) -> std::optional<LogRole> {
    const auto* found = std::find_if(std::begin(kColumnNames), std::end(kColumnNames),
                                     [&](const auto& each) { return each.name == wanted; });
    return found == std::end(kColumnNames) ? std::nullopt : std::optional(found->role);
  };
  if (const auto role = find(name)) return role;
  if (const auto slash = name.find('/'); slash != std::string_view::npos) return find(name.substr(0, slash));
  for (const std::string_view unit : {"ms", "us", "hex", "dec", "sec", "s"})
    if (name.size() > unit.size() + 1 && name.ends_with(unit))
      if (const auto role = find(name.substr(0, name.size() - unit.size()))) return role;
  return std::nullopt;
}

bool is_delta_name(std::string_view name) {
  constexpr std::string_view kNames[] = {"reltime",
                                         "deltatime",
                                         "timedelta",
                                         "delta",
                                         "deltat",
                                         "dt",
                                         "zeitdifferenz",
                                         "相对时间",
                                         "时间间隔",
                                         "\xCF\xE0\xB6\xD4\xCA\xB1\xBC\xE4",
                                         "\xCA\xB1\xBC\xE4\xBC\xE4\xB8\xF4"};
  const auto is = [&](std::string_view each) {
    return name == each ||
           (name.starts_with(each) && (name.substr(each.size()) == "s" || name.substr(each.size()) == "ms" ||
                                       name.substr(each.size()) == "us"));
  };
  return std::any_of(std::begin(kNames), std::end(kNames), is);
}

void take_qualifier(LogRole role, const HeaderName& name, LogNumbers& out) {
  const auto says = [&](std::string_view word) {
    return name.qualifier.find(word) != std::string::npos ||
           (name.name.size() > word.size() + 1 && name.name.ends_with(word));
  };
  const unsigned base = says("hex") || says("十六进制")                ? 16
                        : says("dec") || says("dez") || says("十进制") ? 10
                                                                       : 0;
  if (role == LogRole::id && base != 0) out.id_base = base;
  if ((role == LogRole::data || role == LogRole::byte) && base != 0) out.data_base = base;
  if (role != LogRole::time) return;
  const bool from_start = says("start") || says("begin");
  out.relative = !from_start && (says("rel") || says("delta") || says("diff"));
  if (says("ms"))
    out.unit = TimeUnit::milliseconds;
  else if (says("us") || says("µs") || says("μs") || says("\xB5s"))
    out.unit = TimeUnit::microseconds;
  else if (name.qualifier == "s" || says("sec") || says("seconds"))
    out.unit = TimeUnit::seconds;
}

}  // namespace servoctl::can
