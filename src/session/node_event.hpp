#pragma once

#include <cstdint>
#include <string>
#include <variant>

#include "base/time.hpp"
#include "canopen/emergency.hpp"
#include "session/node_state.hpp"

namespace servoctl::session {

/// Something a node sent unasked, or stopped sending, on any network.
struct NodeEvent {
  /// It has started, with what it keeps by itself: whatever else was written is gone.
  struct BootUp {};
  struct StateChange {
    NodeState state;
  };
  /// It has fallen silent; reported once, until it is back.
  struct Gone {
    enum class Sign : std::uint8_t {
      heartbeat,  ///< What it sends by itself stays away.
      guarding,   ///< It does not answer the question whether it lives.
      toggle,     ///< It answers that question, and its answers do not change their toggle bit.
      counter,    ///< Frames go past it: no working counter.
    };
    Duration silence;
    Sign sign = Sign::heartbeat;
  };
  /// It answers guarding again. A node whose heartbeat is back gives StateChange.
  struct Back {
    NodeState state;
  };
  /// Two nodes answer under this number; what it was noticed by.
  struct Doubled {
    std::string by;
  };
  /// It refused or left a state, and says why: the code as it told it, and what that means. Not on CAN.
  struct StateError {
    std::uint16_t code = 0;
    std::string text;
  };
  using What = std::variant<BootUp, StateChange, Gone, canopen::Emergency, Back, Doubled, StateError>;

  TimePoint time;  ///< On the clock of the network.
  std::uint8_t node = 0;
  What what;
  std::uint32_t times = 1;  ///< How often in succession the node told the same emergency, or a boot-up.
};

}  // namespace servoctl::session
