#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/result.hpp"

namespace servoctl::can {

/// What stands behind `slcan:`.
struct SlcanPlace {
  std::string device;            ///< `/dev/ttyACM0`
  std::uint32_t bitrate = 0;     ///< Of the bus, in bit/s; one of the protocol's nine.
  std::uint32_t baud = 115'200;  ///< Of the serial line; of no consequence where that is USB itself.
  bool operator==(const SlcanPlace&) const = default;
};

/// The whole name of the bus: `slcan:/dev/ttyUSB0@500k,57600`, without a baud rate that is the usual one.
std::string slcan_url(const SlcanPlace& place);

/// Reads `/dev/ttyACM0@1M`, and the port alone for what sets the bitrate itself: `/dev/ttyACM0`,
/// `/dev/ttyUSB0@500k,57600`. Errors as parse_slcan_place().
Result<SlcanPlace> parse_slcan_port(std::string_view text);

/// Reads `/dev/ttyACM0@1M`, `/dev/ttyUSB0@500k,57600`. Errc::usage with the form, and with the bitrates that
/// there are.
Result<SlcanPlace> parse_slcan_place(std::string_view text);

}  // namespace servoctl::can
