#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "session/identity.hpp"

namespace servoctl::session {

/// What nodes said they are, read once a session: forgotten when a node restarts, another may stand there
/// then.
class KnownIdentities {
 public:
  /// Null where it was not read since the node's boot-up number `boots`.
  const Identity* find(std::uint8_t node, std::uint32_t boots) const {
    const auto found = known_.find(node);
    return found == known_.end() || found->second.boots != boots ? nullptr : &found->second.identity;
  }
  void keep(Identity identity, std::uint32_t boots) {
    auto& known = known_[identity.node];
    if (known.boots != boots) known.told.clear();
    known.boots = boots;
    known.identity = std::move(identity);
  }
  void forget(std::uint8_t node) { known_.erase(node); }
  /// Whether this is to be reported for the node: true once, until it restarts.
  bool is_news(std::uint8_t node, const std::string& what) {
    const auto found = known_.find(node);
    return found == known_.end() || found->second.told.insert(what).second;
  }

 private:
  struct Known {
    Identity identity;
    std::uint32_t boots = 0;
    std::set<std::string> told;
  };
  std::map<std::uint8_t, Known> known_;
};

}  // namespace servoctl::session
