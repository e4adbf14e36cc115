#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "can/frame.hpp"

namespace servoctl::can {

/// What was wrong on the wire, in an error frame of the kernel (linux/can/error.h). Drivers tell what their
/// controller tells them; many tell nothing.
enum class WireError : std::uint8_t {
  acknowledge,  ///< Nobody acknowledged what was sent.
  bit,          ///< Another level than the one that was sent.
  dominant,     ///< A dominant bit was sent and stayed recessive.
  recessive,    ///< A recessive bit was sent, where nobody else may send, and was dominant.
  stuff,        ///< Six equal bits in a row.
  form,         ///< A bit of fixed form has the wrong level.
  checksum,     ///< The CRC of a frame.
  overload,
  transceiver,  ///< The transceiver reports its wires.
  other,        ///< Wrong, and the driver does not say what.
};
inline constexpr std::size_t kWireErrors = 10;

/// `no acknowledge`, `stuff error` …
std::string_view text(WireError error);

/// The error of an error frame; empty for other frames and for reports of the controller's state.
std::optional<WireError> parse_wire_error(const Frame& frame);
/// Whether the controller was sending when it happened.
bool while_sending(const Frame& frame);
/// How many of each were told.
class WireErrors {
 public:
  void add(WireError error) { ++counts_[static_cast<std::size_t>(error)]; }
  std::size_t count(WireError error) const { return counts_[static_cast<std::size_t>(error)]; }
  /// Frames that were damaged on the wire: a missing acknowledge damages none, nor does an overload frame.
  std::size_t damage() const;
  /// `12 × stuff error, 3 × form error`; empty where there were none.
  std::string text() const;

 private:
  std::array<std::size_t, kWireErrors> counts_{};
};

/// What the transceiver says of its wires, in words; empty when it says nothing.
std::string_view transceiver_text(const Frame& frame);

}  // namespace servoctl::can
