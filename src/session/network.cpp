#include "session/network.hpp"

#include "base/format.hpp"

namespace servoctl::session {

std::string Network::silence_hint(std::uint8_t node) const {
  return formatted("is node {} powered and connected? `scan` shows which nodes answer", node);
}

std::string Network::state_order(NodeState state) const {
  return formatted("the request for {}", state_word(state));
}

std::string Network::state_command(std::uint8_t node, NodeState state) const {
  return formatted("state {} -n {}", name(state), node);
}

}  // namespace servoctl::session
