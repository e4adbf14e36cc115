#pragma once

#include <cstdint>

#include "can/frame.hpp"

namespace servoctl::can {

/// Bits a data or remote frame takes on the wire (ISO 11898-1): with its stuff bits, the acknowledge and the
/// three bits of silence that follow. Zero for a report of the controller.
std::uint32_t bits_on_wire(const Frame& frame);

}  // namespace servoctl::can
