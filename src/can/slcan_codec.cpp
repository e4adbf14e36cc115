#include "can/slcan_codec.hpp"

#include <linux/can/error.h>

#include <algorithm>
#include <array>
#include <utility>

#include "base/hex.hpp"
#include "base/number.hpp"

namespace servoctl::can {
namespace {

using LineKind = SlcanLine::Kind;

/// Versions are up to a hundred characters long, frames up to 30.
constexpr std::size_t kMostLine = 200;
/// Lines that wait here at most; whoever reads takes them as they come.
constexpr std::size_t kMostLines = 1U << 20U;
constexpr std::size_t kStampDigits = 4;

constexpr char kReturn = '\r';
constexpr char kLineFeed = '\n';
constexpr char kBell = '\a';

constexpr std::array<std::uint32_t, 9> kRates{10'000,  20'000,  50'000,  100'000,  125'000,
                                              250'000, 500'000, 800'000, 1'000'000};

Frame error_report(std::uint32_t id) {
  Frame out;
  out.error = true;
  out.id = id;
  out.size = CAN_ERR_DLC;
  return out;
}

/// The digits behind the length: data, then perhaps a stamp.
bool read_rest(std::string_view rest, SlcanLine& out) {
  const std::size_t data = out.frame.remote ? 0 : std::size_t{2} * out.frame.size;
  if (rest.size() != data && rest.size() != data + kStampDigits) return false;
  for (std::size_t i = 0; i < data / 2; ++i) {
    const auto byte = parse_digits(rest.substr(2 * i, 2), 16);
    if (!byte) return false;
    out.frame.data[i] = static_cast<std::uint8_t>(*byte);
  }
  if (rest.size() == data) return true;
  const auto stamp = parse_digits(rest.substr(data), 16);
  if (!stamp) return false;
  out.stamp = static_cast<std::uint16_t>(*stamp);
  return true;
}

bool read_frame(std::string_view line, SlcanLine& out) {
  out.frame.extended = line.front() == 'T' || line.front() == 'R';
  out.frame.remote = line.front() == 'r' || line.front() == 'R';
  const std::size_t digits = out.frame.extended ? 8 : 3;
  if (line.size() < digits + 2) return false;
  const auto id = parse_digits(line.substr(1, digits), 16);
  const auto size = parse_digits(line.substr(digits + 1, 1), 10);
  if (!id || !size || *id > (out.frame.extended ? 0x1FFF'FFFFU : 0x7FFU) || *size > 8) return false;
  out.frame.id = static_cast<std::uint32_t>(*id);
  out.frame.size = static_cast<std::uint8_t>(*size);
  return read_rest(line.substr(digits + 2), out);
}

/// `sp128096`: state, then the counters of received and sent frames.
std::optional<Frame> state_report(std::string_view line) {
  if (line.size() != 8) return std::nullopt;
  const auto received = parse_digits(line.substr(2, 3), 10);
  const auto sent = parse_digits(line.substr(5, 3), 10);
  if (!received || !sent) return std::nullopt;
  auto out = error_report(CAN_ERR_CRTL);
  const auto by = [&](int of_sent, int of_received) {
    return static_cast<std::uint8_t>((*sent >= *received ? of_sent : 0) |
                                     (*sent <= *received ? of_received : 0));
  };
  switch (line[1]) {
    case 'a': out.data[1] = CAN_ERR_CRTL_ACTIVE; break;
    case 'w': out.data[1] = by(CAN_ERR_CRTL_TX_WARNING, CAN_ERR_CRTL_RX_WARNING); break;
    case 'p': out.data[1] = by(CAN_ERR_CRTL_TX_PASSIVE, CAN_ERR_CRTL_RX_PASSIVE); break;
    case 'b': out.id = CAN_ERR_BUSOFF; break;
    default: return std::nullopt;
  }
  out.data[6] = static_cast<std::uint8_t>(std::min<std::uint64_t>(*sent, 0xFF));
  out.data[7] = static_cast<std::uint8_t>(std::min<std::uint64_t>(*received, 0xFF));
  return out;
}

/// One letter of `e3bcO`; false for a letter that there is not.
bool add_error(char letter, Frame& out) {
  switch (letter) {
    case 'a': out.id |= CAN_ERR_ACK; return true;
    case 'b': out.data[2] |= CAN_ERR_PROT_BIT0; return true;
    case 'B': out.data[2] |= CAN_ERR_PROT_BIT1; return true;
    case 'c': out.data[3] = CAN_ERR_PROT_LOC_CRC_SEQ; return true;
    case 'f': out.data[2] |= CAN_ERR_PROT_FORM; return true;
    case 's': out.data[2] |= CAN_ERR_PROT_STUFF; return true;
    case 'o':
      out.id |= CAN_ERR_CRTL;
      out.data[1] |= CAN_ERR_CRTL_RX_OVERFLOW;
      return true;
    case 'O':
      out.id |= CAN_ERR_CRTL;
      out.data[1] |= CAN_ERR_CRTL_TX_OVERFLOW;
      return true;
    default: return false;
  }
}

std::optional<Frame> errors_report(std::string_view line) {
  const auto count = line.size() < 3 ? std::nullopt : parse_digits(line.substr(1, 1), 10);
  if (!count || line.size() != 2 + *count) return std::nullopt;
  auto out = error_report(CAN_ERR_PROT | CAN_ERR_BUSERROR);
  for (const char letter : line.substr(2))
    if (!add_error(letter, out)) return std::nullopt;
  return out;
}

SlcanLine parse_line(std::string_view line) {
  SlcanLine out;
  out.text = line;
  if (line.empty() || line == "z" || line == "Z") {
    out.kind = LineKind::acknowledged;
    return out;
  }
  const char first = line.front();
  if (first == 't' || first == 'T' || first == 'r' || first == 'R') {
    out.kind = read_frame(line, out) ? LineKind::frame : LineKind::damaged;
  } else if (first == 'F' && line.size() == 3) {
    const auto flags = parse_digits(line.substr(1), 16);
    if (!flags) return out;
    out.kind = LineKind::flags;
    out.flags = static_cast<std::uint8_t>(*flags);
  } else if (first == 's' || first == 'e') {
    const auto report = first == 's' ? state_report(line) : errors_report(line);
    if (!report) return out;
    out.kind = LineKind::report;
    out.frame = *report;
  }
  return out;
}

}  // namespace

void SlcanReader::put(std::string_view bytes) {
  for (const char byte : bytes) {
    const bool was_return = std::exchange(after_return_, byte == kReturn);
    if (byte == kLineFeed && was_return) continue;
    if (byte == kReturn || byte == kLineFeed) {
      end_line();
    } else if (byte == kBell) {
      // What stands in front of it has lost its end.
      if (!line_.empty() || too_long_) end_line();
      if (lines_.size() < kMostLines) lines_.push_back({.kind = LineKind::refused});
    } else if (line_.size() < kMostLine) {
      line_ += byte;
    } else {
      too_long_ = true;
    }
  }
}

void SlcanReader::end_line() {
  auto line = too_long_ ? SlcanLine{.kind = LineKind::damaged} : parse_line(line_);
  line_.clear();
  too_long_ = false;
  if (line.kind == LineKind::frame && is_odd_one_out(line)) line.kind = LineKind::damaged;
  if (lines_.size() < kMostLines) lines_.push_back(std::move(line));
}

bool SlcanReader::is_odd_one_out(const SlcanLine& frame) {
  constexpr int kEnough = 3;
  const bool stamped = frame.stamp.has_value();
  if (stamped_.value_or(stamped) != stamped && ++odd_ones_ < kEnough) return true;
  stamped_ = stamped;
  odd_ones_ = 0;
  return false;
}

std::optional<SlcanLine> SlcanReader::take() {
  if (lines_.empty()) return std::nullopt;
  auto out = std::move(lines_.front());
  lines_.pop_front();
  return out;
}

std::string slcan_line(const Frame& frame) {
  std::string out;
  const char lower = frame.remote ? 'r' : 't';
  out += frame.extended ? static_cast<char>(lower - 'a' + 'A') : lower;
  append_hex(frame.id, frame.extended ? 8 : 3, out);
  append_hex(frame.size, 1, out);
  for (const auto byte : frame.payload()) append_hex(byte, 2, out);
  return out += kReturn;
}

std::optional<char> slcan_bitrate_digit(std::uint32_t bitrate) {
  const auto* const found = std::find(kRates.begin(), kRates.end(), bitrate);
  if (found == kRates.end()) return std::nullopt;
  return static_cast<char>('0' + (found - kRates.begin()));
}

std::string_view slcan_bitrates_text() { return "10k, 20k, 50k, 100k, 125k, 250k, 500k, 800k, 1M"; }

std::vector<Frame> slcan_reports(std::uint8_t flags) {
  constexpr unsigned kLost = 0x01 | 0x08;
  constexpr unsigned kWarning = 0x04;
  constexpr unsigned kPassive = 0x20;
  constexpr unsigned kBusError = 0x80;
  std::vector<Frame> out;
  const auto add_state = [&out](int state) {
    out.push_back(error_report(CAN_ERR_CRTL));
    out.back().data[1] = static_cast<std::uint8_t>(state);
  };
  if ((flags & kLost) != 0) add_state(CAN_ERR_CRTL_RX_OVERFLOW);
  if ((flags & kPassive) != 0)
    add_state(CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE);
  else if ((flags & kWarning) != 0)
    add_state(CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING);
  if ((flags & kBusError) != 0) out.push_back(error_report(CAN_ERR_PROT | CAN_ERR_BUSERROR));
  return out;
}

}  // namespace servoctl::can
