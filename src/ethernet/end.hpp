#pragma once

#include <cstdint>

namespace servoctl::ethernet {

/// Which end of a wire a port is.
enum class End : std::uint8_t {
  master,  ///< Sends frames, and has them back.
  ring,    ///< Stands for the slaves: frames come, and go back changed.
};

}  // namespace servoctl::ethernet
