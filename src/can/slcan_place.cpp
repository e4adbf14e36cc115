#include "can/slcan_place.hpp"

#include <optional>

#include "base/format.hpp"
#include "base/number.hpp"
#include "can/serial_port.hpp"
#include "can/slcan_codec.hpp"

namespace servoctl::can {
namespace {

/// `500k`, `1M`, `125000`
std::optional<std::uint32_t> slcan_bitrate(std::string_view text) {
  std::uint64_t scale = 1;
  if (!text.empty() && (text.back() == 'k' || text.back() == 'K')) scale = 1'000;
  if (!text.empty() && (text.back() == 'M' || text.back() == 'm')) scale = 1'000'000;
  if (scale > 1) text.remove_suffix(1);
  const auto number = parse_digits(text, 10);
  if (!number || *number > 1'000'000) return std::nullopt;
  const auto out = *number * scale;
  if (out > 1'000'000 || !slcan_bitrate_digit(static_cast<std::uint32_t>(out))) return std::nullopt;
  return static_cast<std::uint32_t>(out);
}

tl::unexpected<Error> no_slcan_place(std::string_view text, const Message& why) {
  return fail(Errc::usage, message("slcan:{}: {}", as_it_is(text), why),
              message("write slcan:/dev/ttyACM0@500k: the port, and a bitrate of {}; where the port is a "
                      "real serial line, its baud rate behind: slcan:/dev/ttyUSB0@500k,57600",
                      slcan_bitrates_text()));
}

}  // namespace

std::string slcan_url(const SlcanPlace& place) {
  const auto rate = place.bitrate >= 1'000'000 ? formatted("{}M", place.bitrate / 1'000'000)
                                               : formatted("{}k", place.bitrate / 1'000);
  auto out = formatted("slcan:{}@{}", place.device, rate);
  if (place.baud != SlcanPlace().baud) out += formatted(",{}", place.baud);
  return out;
}

Result<SlcanPlace> parse_slcan_port(std::string_view text) {
  if (text.find('@') == std::string_view::npos && !text.empty())
    return SlcanPlace{.device = std::string(text)};
  return parse_slcan_place(text);
}

Result<SlcanPlace> parse_slcan_place(std::string_view text) {
  const auto at = text.rfind('@');
  if (at == std::string_view::npos) return no_slcan_place(text, "the bitrate of the bus is missing");
  if (at == 0) return no_slcan_place(text, "the port is missing");
  SlcanPlace out{.device = std::string(text.substr(0, at))};
  const auto rates = text.substr(at + 1);
  const auto comma = rates.find(',');
  const auto bitrate = slcan_bitrate(rates.substr(0, comma));
  if (!bitrate)
    return no_slcan_place(
        text, message("'{}' is no bitrate that such an adapter has", as_it_is(rates.substr(0, comma))));
  out.bitrate = *bitrate;
  if (comma == std::string_view::npos) return out;
  const auto baud = parse_baud(rates.substr(comma + 1));
  if (!baud)
    return no_slcan_place(
        text, message("'{}' is no baud rate of a serial port", as_it_is(rates.substr(comma + 1))));
  out.baud = *baud;
  return out;
}

}  // namespace servoctl::can
