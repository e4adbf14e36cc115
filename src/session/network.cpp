#include "session/network.hpp"

#include <fmt/format.h>

namespace servoctl::session {

std::string Network::silence_hint(std::uint8_t node) const {
  return fmt::format("is node {} powered and connected? `scan` shows which nodes answer", node);
}

std::string Network::state_order(NodeState state) const {
  return fmt::format("the request for {}", state_word(state));
}

std::string Network::state_command(std::uint8_t node, NodeState state) const {
  return fmt::format("state {} -n {}", name(state), node);
}

}  // namespace servoctl::session
