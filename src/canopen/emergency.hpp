#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "can/frame.hpp"

namespace servoctl::canopen {

/// An emergency message (CiA 301, 7.2.7): what went wrong on a node, sent once.
struct Emergency {
  std::uint8_t node = 0;
  std::uint16_t code = 0;                ///< Error code; 0x00xx: error reset or no error.
  std::uint8_t error_register = 0;       ///< Object 1001h.
  std::array<std::uint8_t, 5> vendor{};  ///< Manufacturer-specific bytes 3 to 7.
  std::uint8_t size = 8;                 ///< Bytes the drive really sent; some send fewer than 8.

  bool operator==(const Emergency&) const = default;
  bool is_reset() const { return (code & 0xFF00U) == 0; }
};

/// Takes EMCY frames of the pre-defined connection set apart; 2 bytes are enough. SYNC (080h) is none.
std::optional<Emergency> parse_emergency(const can::Frame& frame);
/// The same, of a frame whose CAN-ID is known to be that of this node's emergencies (1014h).
std::optional<Emergency> parse_emergency(const can::Frame& frame, std::uint8_t node);
/// Under the CAN-ID of the pre-defined connection set.
can::Frame emergency_frame(const Emergency& emergency);

/// The class of an error code in the words of CiA 301, table 26: `temperature`, `voltage`, `heartbeat or life
/// guard error`.
std::string emergency_text(std::uint16_t code);

/// Bits of the error register (1001h) that are set: `generic, voltage`; `none` for 0.
std::string error_register_text(std::uint8_t value);

}  // namespace servoctl::canopen
