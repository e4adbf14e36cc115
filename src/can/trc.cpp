#include "can/trc.hpp"

#include <linux/can/error.h>

#include <algorithm>
#include <array>

#include "base/number.hpp"
#include "base/text.hpp"

namespace servoctl::can {
namespace {

using TrcKind = AscLine::Kind;

/// The letters are those of $COLUMNS: N number, O time, B bus, T type, I identifier, d direction, R reserved,
/// L length code, l length, D data. In versions 1.x the type is the direction.
struct TrcVersion {
  std::string_view name;
  std::string_view columns;
};
constexpr std::array<TrcVersion, 4> kVersions{
    {{"1.0", "NOILD"}, {"1.1", "NOTILD"}, {"1.2", "NOBTILD"}, {"1.3", "NOBTIRLD"}}};

constexpr std::string_view kVersionKey = ";$FILEVERSION=";
constexpr std::string_view kStartKey = ";$STARTTIME=";
constexpr std::string_view kColumnsKey = ";$COLUMNS=";
constexpr std::size_t kMostColumns = 16;
constexpr std::size_t kMostWords = kMostColumns + 8;

std::vector<std::string_view> trc_words(std::string_view line) {
  std::vector<std::string_view> out;
  for (line = trim(line); !line.empty() && out.size() < kMostWords; line = trim(line)) {
    const auto end = std::min(line.find_first_of(" \t"), line.size());
    out.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
  return out;
}

/// Milliseconds with up to three decimals: `17535.400`, `1841`.
std::optional<Duration> milliseconds_of(std::string_view text) {
  const auto point = std::min(text.find('.'), text.size());
  const auto whole = point > 12 ? std::nullopt : parse_digits(text.substr(0, point), 10);
  if (!whole) return std::nullopt;
  auto micros = static_cast<std::int64_t>(*whole) * 1000;
  if (point == text.size()) return Duration(micros);
  const auto behind = text.substr(point + 1);
  const auto fraction = behind.size() > 3 ? std::nullopt : parse_digits(behind, 10);
  if (!fraction) return std::nullopt;
  auto part = static_cast<std::int64_t>(*fraction);
  for (auto i = behind.size(); i < 3; ++i) part *= 10;
  return Duration(micros + part);
}

/// 4 digits for 11 bits, 8 for 29.
bool read_trc_id(std::string_view text, Frame& out) {
  const auto id = parse_digits(text, 16);
  out.extended = text.size() > 4;
  if (!id || *id > (out.extended ? 0x1FFF'FFFFU : 0x7FFU)) return false;
  out.id = static_cast<std::uint32_t>(*id);
  return true;
}

bool read_trc_data(const std::vector<std::string_view>& words, std::size_t at, Frame& out) {
  if (at < words.size() && equals_nocase(words[at], "RTR")) out.remote = true;
  if (out.remote) return true;
  for (std::size_t i = 0; i < out.size; ++i) {
    const auto byte =
        at + i < words.size() && words[at + i].size() == 2 ? parse_digits(words[at + i], 16) : std::nullopt;
    if (!byte) return false;
    out.data[i] = static_cast<std::uint8_t>(*byte);
  }
  return true;
}

Frame trc_error_frame() {
  Frame out;
  out.error = true;
  out.id = CAN_ERR_PROT;
  out.size = CAN_ERR_DLC;
  return out;
}

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> list) {
  return std::any_of(list.begin(), list.end(),
                     [&](std::string_view each) { return equals_nocase(word, each); });
}

}  // namespace

TrcReader::TrcReader() { order_.assign(kVersions[0].columns.begin(), kVersions[0].columns.end()); }

void TrcReader::read_header(std::string_view line) {
  if (starts_with_nocase(line, kVersionKey)) {
    const auto version = trim(line.substr(kVersionKey.size()));
    for (const auto& known : kVersions)
      if (version == known.name) order_.assign(known.columns.begin(), known.columns.end());
  } else if (starts_with_nocase(line, kColumnsKey)) {
    std::vector<char> order;
    for (const auto word : split(trim(line.substr(kColumnsKey.size())), ','))
      if (const auto letter = trim(word); letter.size() == 1 && order.size() < kMostColumns)
        order.push_back(letter.front());
    if (!order.empty()) order_ = std::move(order);
  } else if (starts_with_nocase(line, kStartKey)) {
    // Days since 1899-12-30, in the time of the computer.
    const auto days = parse_real(trim(line.substr(kStartKey.size())));
    constexpr double kDaysTo1970 = 25569;
    constexpr double kMostDays = 100'000;
    if (days && *days >= kDaysTo1970 && *days < kMostDays)
      clock_ = {LogClock::Kind::local,
                Duration(static_cast<std::int64_t>((*days - kDaysTo1970) * 86'400'000) * 1000)};
  }
}

AscLine TrcReader::read(std::string_view line) {
  const auto text = trim(line);
  if (text.starts_with(';')) read_header(text);
  if (text.empty() || text.starts_with(';')) return {};
  return read_event(trc_words(text));
}

AscLine TrcReader::read_event(const std::vector<std::string_view>& words) const {
  const auto at = [&](char letter) -> std::size_t {
    return static_cast<std::size_t>(std::find(order_.begin(), order_.end(), letter) - order_.begin());
  };
  const auto word = [&](char letter) {
    return at(letter) < order_.size() && at(letter) < words.size() ? words[at(letter)] : std::string_view();
  };
  const auto time = milliseconds_of(word('O'));
  if (!time) return {TrcKind::malformed};
  const auto bus = parse_digits(word('B'), 10) ? word('B') : std::string_view("1");
  AscLine out{TrcKind::frame, {*time, "can" + std::string(bus), {}}};
  const auto type = word('T');
  auto& frame = out.frame.frame;
  if (is_one_of(type, {"ER", "Error"}) ||
      (type.empty() && words.size() > at('D') && words[at('D')] == "ERROR")) {
    frame = trc_error_frame();
    return out;
  }
  if (is_one_of(type, {"FD", "FB", "FE", "BI"})) return {TrcKind::unsuited};
  // `Warng`, `ST`, `EC`, `EV`: what the hardware says; 1.0 has an identifier for it.
  if (!type.empty() && !is_one_of(type, {"Rx", "Tx", "DT", "RR"})) return {};
  if (type.empty() && word('I') == "FFFFFFFF") return {};
  const bool by_code = at('L') < order_.size();
  const auto size = parse_digits(word(by_code ? 'L' : 'l'), 10);
  if (!read_trc_id(word('I'), frame) || !size) return {TrcKind::malformed};
  // A length code of 9 to 15 means 8 bytes; more bytes are of another protocol.
  const bool longer =
      words.size() > at('D') + frame.data.size() && parse_digits(words[at('D') + frame.data.size()], 16);
  if (*size > (by_code ? 15 : 8) || (*size > 8 && longer)) return {TrcKind::unsuited};
  frame.size = static_cast<std::uint8_t>(std::min<std::uint64_t>(*size, frame.data.size()));
  frame.remote = equals_nocase(type, "RR");
  if (!read_trc_data(words, at('D'), frame)) return {TrcKind::malformed};
  return out;
}

bool is_trc(std::string_view beginning) {
  constexpr std::size_t kMostLines = 30;
  for (std::size_t i = 0; i < kMostLines && !beginning.empty(); ++i) {
    const auto end = std::min(beginning.find('\n'), beginning.size());
    const auto line = trim(beginning.substr(0, end));
    beginning.remove_prefix(std::min(end + 1, beginning.size()));
    if (starts_with_nocase(line, kVersionKey)) return true;
    // The ruler above the columns of 1.0, which has no version.
    if (line.starts_with(";---")) return true;
    if (!line.empty() && line.front() != ';') return false;
  }
  return false;
}

}  // namespace servoctl::can
