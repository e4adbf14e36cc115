#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "base/bytes.hpp"

namespace servoctl::modbus {

/// How messages stand on a wire: RTU and ASCII on a serial line (MODBUS over Serial Line V1.02, 2.5), TCP
/// with the MBAP header (MODBUS Messaging on TCP/IP V1.0b, 3.1).
enum class Framing : std::uint8_t { rtu, ascii, tcp };

/// A PDU with its unit. `transaction` is of TCP alone: an answer has that of its request.
struct Message {
  std::uint8_t unit = 0;
  std::uint16_t transaction = 0;
  Bytes pdu;

  bool operator==(const Message&) const = default;
};

/// CRC of RTU: polynomial A001h, start FFFFh; the low byte is sent first (2.5.1.2).
std::uint16_t crc16(ByteSpan bytes);
/// LRC of ASCII: the two's complement of the sum (2.5.2.2).
std::uint8_t lrc(ByteSpan bytes);

/// The bytes of a message as they are sent.
Bytes frame(Framing framing, const Message& message);

/// Takes bytes as they come in and gives whole messages. Knows no clock: whoever feeds it says when the line
/// was silent.
class Deframer {
 public:
  /// What comes in: their form tells where a message of RTU ends.
  enum class Expects : std::uint8_t { answers, requests };

  Deframer(Framing framing, Expects expects) : framing_(framing), expects_(expects) {}

  void push(ByteSpan bytes);
  /// Nothing came for as long as ends a message: what is no message by now is damaged, or one of an unknown
  /// function.
  void on_silence();
  std::optional<Message> take();

  /// A message has begun, and is not whole.
  bool pending() const { return !buffer_.empty(); }
  /// Bytes that were no message, since the last call.
  std::size_t take_damaged();
  /// A stream of TCP that is out of step: nothing behind it can be understood.
  bool broken() const { return broken_; }
  void clear();

 private:
  void drop_zeros();
  void parse_rtu();
  void parse_ascii();
  void parse_tcp();
  std::optional<std::size_t> rtu_length() const;
  bool take_rtu(std::size_t length);

  Framing framing_;
  Expects expects_;
  Bytes buffer_;
  std::deque<Message> messages_;
  std::size_t damaged_ = 0;
  bool broken_ = false;
};

}  // namespace servoctl::modbus
