#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace servoctl::can {

/// One classical CAN frame (ISO 11898-1): 11-bit identifier unless `extended`, up to 8 bytes.
struct Frame {
  std::uint32_t id = 0;   ///< 11 bits, or 29 when `extended`; without flags.
  std::uint8_t size = 0;  ///< Data length code, 0..8.
  bool extended = false;  ///< 29-bit identifier.
  bool remote = false;    ///< Remote transmission request: no data, `size` is the length asked for.
  bool error = false;     ///< Not a frame of the bus but a report of the controller (error state, bus-off).
  std::array<std::uint8_t, 8> data{};

  std::span<const std::uint8_t> payload() const { return std::span(data).first(remote ? 0 : size); }
  bool operator==(const Frame&) const = default;
};

/// A data frame with an 11-bit identifier.
Frame make_frame(std::uint32_t id, std::span<const std::uint8_t> data);

/// The compact notation of can-utils: `601#4041600000000000`, `701#R`, `00000123#00` for 29 bits,
/// `20000040#0000000000000000` for a report of the controller.
std::string to_string(const Frame& frame);
void append(const Frame& frame, std::string& out);

/// Reads the compact notation; empty when the text is not of this form or names more than 8 bytes.
std::optional<Frame> parse_frame(std::string_view text);

}  // namespace servoctl::can
