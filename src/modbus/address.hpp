#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "can/serial_port.hpp"
#include "modbus/framing.hpp"

namespace servoctl::modbus {

/// How a serial line is set: `19200,8E1`, `115200,8N1,ascii`. By default as MODBUS over Serial Line V1.02,
/// 2.5.1, asks for.
struct SerialSettings {
  can::SerialLine line{.device = {}, .baud = 19'200, .parity = 'E'};
  Framing framing = Framing::rtu;

  /// `19200,8E1`, with `,ascii` where it is that.
  std::string text() const;
  /// Of one character, with start, parity and stop bits.
  unsigned bits_per_character() const {
    return 1U + line.data_bits + (line.parity == 'N' ? 0U : 1U) + line.stop_bits;
  }
};

struct TcpAddress {
  std::string host;
  std::uint16_t port = 502;

  std::string text() const;  ///< `host:502`; a host with colons in brackets.
};

/// `/dev/ttyUSB0`, `/dev/ttyUSB0@115200`, `/dev/ttyUSB0@19200,8E1,ascii`. Errc::usage.
Result<SerialSettings> parse_serial(std::string_view text);
/// `host`, `host:1502`, `[::1]:502`. Errc::usage.
Result<TcpAddress> parse_tcp(std::string_view text);

}  // namespace servoctl::modbus
