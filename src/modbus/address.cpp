#include "modbus/address.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"

namespace servoctl::modbus {
namespace {

constexpr std::string_view kSerialForm =
    "a serial line is written modbus:/dev/ttyUSB0@19200,8E1 (bits per second, data bits, parity N, E or O, "
    "stop bits), with ,ascii for ASCII frames";
constexpr std::string_view kTcpForm = "a device on TCP is written modbus://HOST or modbus://HOST:502";

tl::unexpected<Error> wrong(servoctl::Message what, std::string_view form) {
  return fail(Errc::usage, std::move(what), std::string(form));
}

bool read_characters(std::string_view text, SerialSettings& out) {
  if (text.size() != 3) return false;
  const char parity = text[1] >= 'a' ? static_cast<char>(text[1] - 'a' + 'A') : text[1];
  if ((text[0] != '7' && text[0] != '8') || (parity != 'N' && parity != 'E' && parity != 'O') ||
      (text[2] != '1' && text[2] != '2'))
    return false;
  out.line.data_bits = static_cast<std::uint8_t>(text[0] - '0');
  out.line.parity = parity;
  out.line.stop_bits = static_cast<std::uint8_t>(text[2] - '0');
  return true;
}

Result<void> read_part(std::string_view part, bool first, SerialSettings& out) {
  if (first) {
    const auto baud = can::parse_baud(part);
    if (!baud) return wrong(message("'{}' is not a speed in bits per second", as_it_is(part)), kSerialForm);
    out.line.baud = *baud;
    return {};
  }
  if (equals_nocase(part, "ascii"))
    out.framing = Framing::ascii;
  else if (equals_nocase(part, "rtu"))
    out.framing = Framing::rtu;
  else if (!read_characters(part, out))
    return wrong(message("'{}' is not the form of a character: write 8E1, 8N1, 8O1 or 8N2", as_it_is(part)),
                 kSerialForm);
  return {};
}

}  // namespace

std::string SerialSettings::text() const { return line.text() + (framing == Framing::ascii ? ",ascii" : ""); }

std::string TcpAddress::text() const {
  return host.find(':') == std::string::npos ? formatted("{}:{}", host, port)
                                             : formatted("[{}]:{}", host, port);
}

Result<SerialSettings> parse_serial(std::string_view text) {
  SerialSettings out;
  const auto at = text.rfind('@');
  out.line.device = std::string(text.substr(0, at));
  if (out.line.device.empty()) return wrong("no serial port is named", kSerialForm);
  auto rest = at == std::string_view::npos ? std::string_view() : text.substr(at + 1);
  if (at != std::string_view::npos && rest.empty()) return wrong("nothing stands behind @", kSerialForm);
  for (bool first = true; !rest.empty(); first = false) {
    const auto comma = rest.find(',');
    if (const auto read = read_part(rest.substr(0, comma), first, out); !read) return fail(read.error());
    rest = comma == std::string_view::npos ? std::string_view() : rest.substr(comma + 1);
  }
  if (out.framing == Framing::rtu && out.line.data_bits != 8)
    return wrong("RTU frames need 8 data bits", kSerialForm);
  return out;
}

Result<TcpAddress> parse_tcp(std::string_view text) {
  TcpAddress out;
  std::string_view port;
  if (text.starts_with('[')) {
    const auto end = text.find(']');
    if (end == std::string_view::npos) return wrong(message("'{}': ] is missing", as_it_is(text)), kTcpForm);
    out.host = std::string(text.substr(1, end - 1));
    if (end + 1 < text.size()) port = text.substr(end + 1);
  } else {
    const auto colon = text.find(':');
    out.host = std::string(text.substr(0, colon));
    if (colon != std::string_view::npos) port = text.substr(colon);
  }
  if (out.host.empty()) return wrong("no host is named", kTcpForm);
  if (port.empty()) return out;
  const auto number = port.front() == ':' ? parse_digits(port.substr(1), 10) : std::nullopt;
  if (!number || *number == 0 || *number > 65535)
    return wrong(message("'{}' is not a TCP port", as_it_is(port)), kTcpForm);
  out.port = static_cast<std::uint16_t>(*number);
  return out;
}

}  // namespace servoctl::modbus
