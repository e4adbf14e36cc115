#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "can/frame.hpp"

namespace servoctl::can {

/// What a CAN controller, or the kernel, reports of itself in an error frame (linux/can/error.h).
enum class ControllerReport : std::uint8_t {
  bus_off,           ///< It has left the bus after too many errors and sends nothing.
  restarted,         ///< It takes part again.
  error_passive,     ///< Many errors; it no longer marks those of others.
  error_warning,     ///< More errors than usual.
  error_active,      ///< Healthy again.
  overflow,          ///< Frames were lost because nobody read them in time.
  transmit_timeout,  ///< A frame could not be sent in time.
};

/// The gravest thing that an error frame reports; empty for other frames and reports.
std::optional<ControllerReport> parse_report(const Frame& frame);

/// What it means, for a person: `bus-off: the controller has left the bus after too many errors`.
std::string_view text(ControllerReport report);

}  // namespace servoctl::can
