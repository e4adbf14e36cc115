#include "cli/heard_starts.hpp"

#include <algorithm>

#include "canopen/node_id.hpp"

namespace servoctl::cli {

HeardStarts::HeardStarts(const std::vector<session::Session*>& sessions) {
  for (auto* session : sessions) {
    // One that a thread has for itself is heard by that.
    if (!session->options().beside) continue;
    Heard heard{session, {}};
    for (int node = 0; node <= canopen::kLastNode; ++node)
      heard.starts.push_back(session->watch().boots(static_cast<std::uint8_t>(node)));
    heard_.push_back(std::move(heard));
  }
}

std::optional<std::uint8_t> HeardStarts::started_since(std::span<const std::uint8_t> nodes) const {
  const bool all = nodes.empty() || std::ranges::find(nodes, 0) != nodes.end();
  for (const auto& heard : heard_) {
    (void)heard.session->listen();
    for (std::uint8_t node = canopen::kFirstNode; node <= canopen::kLastNode; ++node)
      if ((all || std::ranges::find(nodes, node) != nodes.end()) &&
          heard.session->watch().boots(node) != heard.starts[node])
        return node;
  }
  return std::nullopt;
}

}  // namespace servoctl::cli
