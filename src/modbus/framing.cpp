#include "modbus/framing.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <string_view>
#include <utility>

#include "modbus/pdu.hpp"

namespace servoctl::modbus {
namespace {

constexpr std::size_t kCrc = 2;
/// Unit, PDU and CRC (MODBUS over Serial Line, 2.5.1.1).
constexpr std::size_t kLongestRtu = 256;
/// Two characters a byte, `:`, CR and LF (2.5.2.1).
constexpr std::size_t kLongestAscii = 513;
constexpr std::size_t kMbap = 7;

Bytes body_of(const Message& message) {
  Bytes out{message.unit};
  out.insert(out.end(), message.pdu.begin(), message.pdu.end());
  return out;
}

Bytes rtu_frame(const Message& message) {
  auto out = body_of(message);
  const auto crc = crc16(out);
  out.push_back(static_cast<std::uint8_t>(crc & 0xFFU));
  out.push_back(static_cast<std::uint8_t>(crc >> 8U));
  return out;
}

Bytes ascii_frame(const Message& message) {
  auto body = body_of(message);
  body.push_back(lrc(body));
  const auto text = ":" + to_hex(body, "") + "\r\n";
  return {text.begin(), text.end()};
}

Bytes tcp_frame(const Message& message) {
  Bytes out;
  append_be16(out, message.transaction);
  append_be16(out, 0);
  append_be16(out, static_cast<std::uint16_t>(message.pdu.size() + 1));
  const auto body = body_of(message);
  out.insert(out.end(), body.begin(), body.end());
  return out;
}

}  // namespace

std::uint16_t crc16(ByteSpan bytes) {
  std::uint16_t crc = 0xFFFF;
  for (const auto byte : bytes) {
    crc = static_cast<std::uint16_t>(crc ^ byte);
    for (int bit = 0; bit < 8; ++bit)
      crc = static_cast<std::uint16_t>((crc & 1U) != 0 ? (crc >> 1U) ^ 0xA001U : crc >> 1U);
  }
  return crc;
}

std::uint8_t lrc(ByteSpan bytes) {
  const auto sum = std::accumulate(bytes.begin(), bytes.end(), 0U);
  return static_cast<std::uint8_t>(0U - sum);
}

Bytes frame(Framing framing, const Message& message) {
  switch (framing) {
    case Framing::rtu: return rtu_frame(message);
    case Framing::ascii: return ascii_frame(message);
    case Framing::tcp: break;
  }
  return tcp_frame(message);
}

void Deframer::push(ByteSpan bytes) {
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  switch (framing_) {
    case Framing::rtu: return parse_rtu();
    case Framing::ascii: return parse_ascii();
    case Framing::tcp: return parse_tcp();
  }
}

/// By the function code, where it is one that is known; else the silence behind it tells.
std::optional<std::size_t> Deframer::rtu_length() const {
  if (buffer_.size() < 3) return std::nullopt;
  const auto function = buffer_[1];
  const bool answers = expects_ == Expects::answers;
  if (answers && (function & kExceptionBit) != 0) return 3 + kCrc;
  switch (static_cast<Function>(function)) {
    case Function::read_coils:
    case Function::read_inputs:
    case Function::read_registers: return answers ? std::size_t{3} + buffer_[2] + kCrc : 6 + kCrc;
    case Function::write_register: return 6 + kCrc;
    case Function::write_registers:
      if (answers) return 6 + kCrc;
      return buffer_.size() < 7 ? std::nullopt : std::optional(std::size_t{7} + buffer_[6] + kCrc);
  }
  return std::nullopt;
}

bool Deframer::take_rtu(std::size_t length) {
  const auto body = ByteSpan(buffer_).first(length - kCrc);
  const auto crc = static_cast<std::uint16_t>(buffer_[length - 2] | (buffer_[length - 1] << 8U));
  if (crc16(body) != crc) return false;
  messages_.push_back({body[0], 0, Bytes(body.begin() + 1, body.end())});
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(length));
  return true;
}

/// No answer is of unit 0: such a byte comes of a line whose direction changes.
void Deframer::drop_zeros() {
  if (expects_ != Expects::answers) return;
  const auto begin =
      std::find_if(buffer_.begin(), buffer_.end(), [](std::uint8_t byte) { return byte != 0; });
  damaged_ += static_cast<std::size_t>(begin - buffer_.begin());
  buffer_.erase(buffer_.begin(), begin);
}

/// A wrong sum says nothing of where the next message begins: silence does.
void Deframer::parse_rtu() {
  drop_zeros();
  for (auto length = rtu_length(); length && buffer_.size() >= *length; length = rtu_length())
    if (take_rtu(*length))
      drop_zeros();
    else
      break;
  // Noise that never ends.
  if (buffer_.size() > 2 * kLongestRtu) {
    damaged_ += buffer_.size();
    buffer_.clear();
  }
}

void Deframer::parse_ascii() {
  for (;;) {
    const auto start = std::find(buffer_.begin(), buffer_.end(), ':');
    damaged_ += static_cast<std::size_t>(start - buffer_.begin());
    buffer_.erase(buffer_.begin(), start);
    const auto end = std::find(buffer_.begin(), buffer_.end(), '\n');
    if (end == buffer_.end()) break;
    // A message that begins anew has no end: the last beginning counts (2.5.2.1).
    const auto last = std::find(std::reverse_iterator(end), buffer_.rend(), ':').base();
    auto text = as_text({&*last, static_cast<std::size_t>(end - last)});
    if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
    const auto body = parse_hex_bytes(text);
    const auto size = static_cast<std::size_t>(end - buffer_.begin()) + 1;
    if (body && body->size() >= 3 && lrc(*body) == 0)
      messages_.push_back({body->front(), 0, Bytes(body->begin() + 1, body->end() - 1)});
    else
      damaged_ += size;
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(size));
  }
  if (buffer_.size() > kLongestAscii) {
    damaged_ += buffer_.size();
    buffer_.clear();
  }
}

void Deframer::parse_tcp() {
  while (!broken_ && buffer_.size() >= kMbap) {
    const auto protocol = load_be16(ByteSpan(buffer_).subspan(2));
    const auto length = load_be16(ByteSpan(buffer_).subspan(4));
    if (protocol != 0 || length < 2 || length > kLongestPdu + 1) {
      broken_ = true;
      break;
    }
    const auto size = kMbap - 1 + length;
    if (buffer_.size() < size) return;
    const auto end = buffer_.begin() + static_cast<std::ptrdiff_t>(size);
    messages_.push_back({buffer_[6], load_be16(buffer_), Bytes(buffer_.begin() + kMbap, end)});
    buffer_.erase(buffer_.begin(), end);
  }
}

void Deframer::on_silence() {
  // The end of a message of TCP is not told by silence.
  if (framing_ != Framing::rtu || buffer_.empty()) return;
  if (buffer_.size() >= 2 + kCrc && buffer_.size() <= kLongestRtu && take_rtu(buffer_.size())) return;
  damaged_ += buffer_.size();
  buffer_.clear();
}

std::optional<Message> Deframer::take() {
  if (messages_.empty()) return std::nullopt;
  auto out = std::move(messages_.front());
  messages_.pop_front();
  return out;
}

std::size_t Deframer::take_damaged() { return std::exchange(damaged_, 0); }

void Deframer::clear() {
  buffer_.clear();
  messages_.clear();
  damaged_ = 0;
  broken_ = false;
}

}  // namespace servoctl::modbus
