#include "can/log_row.hpp"

#include <linux/can/error.h>

#include <algorithm>
#include <string>

#include "base/base64.hpp"
#include "base/number.hpp"
#include "base/text.hpp"

namespace servoctl::can {
namespace {

using LogKind = AscLine::Kind;

constexpr std::uint32_t kMostStandard = 0x7FF;
constexpr std::uint32_t kMostExtended = 0x1FFF'FFFF;
constexpr std::size_t kMostData = 64;
constexpr Duration kDay = std::chrono::hours(24);
constexpr Duration kLatest = std::chrono::seconds(100'000'000'000);

/// The tokens of a cell with all bytes: `81 01`, `81-01`, `x| 81 01`.
template <class Take>
void for_each_byte_word(std::string_view cell, const Take& take) {
  constexpr std::string_view kBetween = " \t,;:-|";
  while (!cell.empty()) {
    const auto end = std::min(cell.find_first_of(kBetween), cell.size());
    const auto word = cell.substr(0, end);
    if (!word.empty() && word != "x") take(word);
    cell.remove_prefix(std::min(end + 1, cell.size()));
  }
}

bool add_bytes(std::string_view word, unsigned base, std::vector<std::uint8_t>& out) {
  const bool packed = !starts_with_nocase(word, "0x") && base == 16 && word.size() > 2;
  const auto step = packed ? 2 : word.size();
  if (word.size() % step != 0) return false;
  for (; !word.empty() && out.size() <= kMostData; word.remove_prefix(step)) {
    const auto byte = parse_log_byte(word.substr(0, step), base);
    if (!byte) return false;
    out.push_back(*byte);
  }
  return true;
}

bool is_blank(std::string_view cell) { return bare_value(cell).empty(); }

bool has_data(const LogCells& cells) { return !std::all_of(cells.data.begin(), cells.data.end(), is_blank); }

/// Up to the first cell that is empty; after it none is filled.
bool read_log_bytes(const LogCells& cells, const LogNumbers& numbers, std::vector<std::uint8_t>& out) {
  out.clear();
  bool good = true;
  for (auto cell = cells.data.begin(); cell != cells.data.end(); ++cell) {
    const auto bare = bare_value(*cell);
    if (bare.empty()) return good && std::all_of(cell, cells.data.end(), is_blank);
    if (numbers.base64) {
      const auto bytes = parse_base64(bare);
      if (!bytes) return false;
      out.assign(bytes->begin(), bytes->end());
      return true;
    }
    for_each_byte_word(
        bare, [&](std::string_view word) { good = good && add_bytes(word, numbers.data_base, out); });
  }
  return good;
}

bool read_log_id(const LogCells& cells, unsigned base, Frame& out) {
  const auto id = parse_log_id(cells.id);
  if (!id) return false;
  const auto in = id->base != 0 ? id->base : base;
  const auto number = parse_digits(id->digits, in);
  // 29 bits have eight digits; more are a decimal number.
  if (!number || *number > kMostExtended || (in == 16 && id->digits.size() > 8)) return false;
  if (!cells.decimal_id.empty() && parse_digits(bare_value(cells.decimal_id), 10) != number) return false;
  const bool told = cells.words.extended || id->extended || is_yes(cells.extended);
  out.id = static_cast<std::uint32_t>(*number);
  out.extended = told || out.id > kMostStandard;
  return !(cells.words.standard && out.extended);
}

Frame log_error_frame() {
  Frame out;
  out.error = true;
  out.id = CAN_ERR_PROT;
  out.size = CAN_ERR_DLC;
  return out;
}

bool is_hex_letter(char c) { return (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F'); }
bool has_letter(std::string_view text) { return std::any_of(text.begin(), text.end(), is_hex_letter); }

/// Whether what the line says of its frame in words is known, and fits the rest: `R` may be a remote frame,
/// or one that was received.
bool is_told_in_words(const LogCells& cells) {
  for (const auto cell : {cells.extended, cells.remote, cells.error, cells.fd})
    if (!yes_or_no(cell)) return false;
  const bool sure = is_yes(cells.remote) || is_yes(cells.error);
  const bool without_data = cells.words.remote || (cells.words.error && !is_blank(cells.id));
  return !cells.words.unknown && (sure || !without_data || !has_data(cells));
}

}  // namespace

void LogCells::clear() {
  auto kept = std::move(data);
  kept.clear();
  *this = {};
  data = std::move(kept);
}

/// Times of a day that begin anew belong to the next day.
void LogRow::take_day(Duration time) {
  constexpr Duration kHalf = kDay / 2;
  if (clock_.kind == LogClock::Kind::none) {
    // A clock that begins at zero is one of the recording.
    if (time < std::chrono::minutes(1)) {
      time_ = time;
      return;
    }
    clock_ = {day_ == Duration::zero() ? LogClock::Kind::day : LogClock::Kind::local, day_};
  }
  if (midnights_ + time + kHalf < time_) midnights_ += kDay;
  time_ = midnights_ + time;
}

bool LogRow::read_time(const LogCells& cells, const LogNumbers& numbers) {
  const auto text = bare_value(cells.time);
  if (text.empty()) return true;
  auto time = parse_log_time(text, numbers.unit);
  if (!time) {
    const bool integer = text.find_first_not_of("0123456789") == std::string_view::npos;
    lacks_unit_ = lacks_unit_ || (integer && numbers.unit == TimeUnit::open);
    return integer && numbers.unit == TimeUnit::open;
  }
  if (!cells.fraction.empty()) {
    const auto fraction = parse_log_time(cells.fraction, TimeUnit::milliseconds);
    if (!fraction || fraction->value >= std::chrono::seconds(1)) return false;
    time->value += fraction->value;
  }
  if (numbers.relative) {
    time_ = std::min(time_ + time->value, kLatest);
  } else if (time->kind == LogTime::Kind::day) {
    const auto date = parse_log_date(bare_value(cells.date));
    if (date) clock_ = {LogClock::Kind::local, Duration::zero()};
    date ? void(time_ = *date + time->value) : take_day(time->value);
  } else {
    time_ = time->value;
    if (time->kind == LogTime::Kind::date) clock_ = {LogClock::Kind::local, Duration::zero()};
  }
  return true;
}

AscLine LogRow::read(const LogCells& cells, const LogNumbers& numbers) {
  if (!read_time(cells, numbers)) return {LogKind::malformed};
  const auto channel = bare_value(cells.channel);
  const bool number = !channel.empty() && channel.find_first_not_of("0123456789") == std::string_view::npos;
  AscLine out{LogKind::frame,
              {time_, channel.empty() ? "can1" : (number ? "can" : "") + std::string(channel), {}}};
  std::replace(out.frame.interface_name.begin(), out.frame.interface_name.end(), ' ', '-');
  auto& frame = out.frame.frame;
  if (!is_told_in_words(cells)) return {LogKind::malformed};
  if (cells.words.error || is_yes(cells.error)) {
    frame = log_error_frame();
    return out;
  }
  if (!read_log_id(cells, numbers.id_base, frame)) return {LogKind::malformed};
  frame.remote = cells.words.remote || is_yes(cells.remote);
  const auto length = parse_log_length(cells.length);
  if (!length && !is_blank(cells.length)) return {LogKind::malformed};
  const bool fd = cells.words.fd || is_yes(cells.fd);
  if (fd || (length && *length > frame.data.size())) return {LogKind::unsuited};
  if (!read_log_bytes(cells, numbers, bytes_)) return {LogKind::malformed};
  if (frame.remote) {
    // Some tools fill them with zeros.
    if (std::any_of(bytes_.begin(), bytes_.end(), [](std::uint8_t byte) { return byte != 0; }))
      return {LogKind::malformed};
    frame.size = static_cast<std::uint8_t>(length.value_or(0));
    return out;
  }
  if (!length && bytes_.size() > frame.data.size()) return {LogKind::unsuited};
  const auto size = length ? *length : bytes_.size();
  if (bytes_.size() < size || (bytes_.size() > size && !cells.data_by_byte)) return {LogKind::malformed};
  frame.size = static_cast<std::uint8_t>(size);
  std::copy_n(bytes_.begin(), size, frame.data.begin());
  return out;
}

void BaseEvidence::add(const LogCells& cells) {
  if (cells.words.error || is_yes(cells.error)) return;
  add_id(cells.id);
  if (cells.words.remote || is_yes(cells.remote)) return;
  for (const auto cell : cells.data)
    for_each_byte_word(bare_value(cell), [this](std::string_view word) { add_data(word); });
}

void BaseEvidence::add_id(std::string_view text) {
  const auto id = parse_log_id(text);
  if (!id || id->base != 0) return;
  id_open_ = true;
  const bool padded = id->digits.size() > 1 && id->digits.size() <= 8 && id->digits.front() == '0';
  id_hex_ = id_hex_ || has_letter(id->digits) || padded;
  const auto hex = parse_digits(id->digits, 16).value_or(0);
  const auto decimal = parse_digits(id->digits, 10).value_or(kMostExtended);
  id_over_ = id_over_ || (hex > kMostStandard && id->digits.size() <= 4 && !id->extended);
  id_over_decimal_ = id_over_decimal_ || decimal > kMostStandard;
}

void BaseEvidence::add_data(std::string_view word) {
  if (starts_with_nocase(word, "0x")) return;
  data_open_ = true;
  const bool padded = word.size() == 2 && word.front() == '0';
  data_hex_ = data_hex_ || has_letter(word) || padded || word.size() > 3;
  data_decimal_ = data_decimal_ || (word.size() == 3 && !has_letter(word));
}

/// A tool has one switch for both as a rule: what one does not tell, the other does.
void BaseEvidence::settle(LogNumbers& numbers) const {
  if (data_hex_ && data_decimal_) return;
  if (numbers.data_base == 0) numbers.data_base = data_hex_ ? 16 : data_decimal_ ? 10 : !data_open_ ? 16 : 0;
  if (numbers.id_base == 0) {
    if (!id_open_ || id_hex_)
      numbers.id_base = 16;
    else if (id_over_ && !id_over_decimal_)
      numbers.id_base = 10;
    else if (data_open_)
      numbers.id_base = data_hex_ ? 16 : data_decimal_ ? 10 : 0;
  }
  if (numbers.data_base == 0 && id_open_)
    numbers.data_base = id_hex_ ? 16 : id_over_ && !id_over_decimal_ ? 10 : 0;
}

bool BaseEvidence::assumed_data(const LogNumbers& before) const {
  return before.data_base == 0 && data_open_ && !data_hex_ && !data_decimal_;
}

bool BaseEvidence::assumed(const LogNumbers& before) const {
  return before.id_base == 0 && id_open_ && !id_hex_;
}

}  // namespace servoctl::can
