#pragma once

#include <cstdint>

namespace servoctl::canopen {

/// How an SDO transfer is made (CiA 301, 7.2.4.1).
enum class Transfer : std::uint8_t {
  automatic,  ///< Writes by their size; reads as the server answers them.
  domain,     ///< As automatic, and a read is expected to be long: block transfer is asked for first.
  expedited,  ///< Up to 4 bytes in one frame; anything longer is refused.
  segmented,  ///< 7 bytes a frame, each acknowledged.
  block,      ///< Up to 127 segments for one acknowledge; never anything else.
};

}  // namespace servoctl::canopen
