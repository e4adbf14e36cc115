#pragma once

#include <cstdint>

#include "base/time.hpp"

namespace servoctl::session {

/// What servoctl sends a node once per period, so that the node notices if servoctl is gone.
struct LifeSign {
  enum class Kind : std::uint8_t {
    heartbeat,  ///< A message of servoctl's own (CiA 301, 7.2.8.2.2.2).
    guarding,   ///< A question to the node (CiA 301, 7.2.8.2.2.1).
    /// Outputs of a process image (ETG.1000.4, 6.3); `period` is how long the node goes on without them.
    process_data,
  };
  Kind kind = Kind::heartbeat;
  std::uint8_t producer = 0;      ///< Of a heartbeat: the node-ID under which servoctl sends it, 1..127.
  Duration period{};              ///< Between two; above zero.
  std::uint32_t life_factor = 1;  ///< Of guarding: so many questions without an answer, and the node is lost.
};

}  // namespace servoctl::session
