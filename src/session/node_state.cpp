#include "session/node_state.hpp"

namespace servoctl::session {

std::string_view name(NodeState state) {
  switch (state) {
    case NodeState::unknown: break;
    case NodeState::initialising: return "boot-up";
    case NodeState::stopped: return "stopped";
    case NodeState::bootstrap: return "bootstrap";
    case NodeState::pre_operational: return "pre-operational";
    case NodeState::safe_operational: return "safe-operational";
    case NodeState::operational: return "operational";
  }
  return "unknown";
}

}  // namespace servoctl::session
