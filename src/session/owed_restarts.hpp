#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "drive/profile.hpp"
#include "session/exchange.hpp"
#include "session/identity.hpp"

namespace servoctl::session {

/// A value that a drive has stored and goes by only after a restart (od::Effect::restart).
struct OwedValue {
  ObjectAddress object;
  std::optional<Bytes> in_force = {};  ///< What the drive goes by now; empty where nobody knows.
  Bytes stored;
  bool earlier = false;  ///< Kept of an earlier session, and not written since.
};

/// Which values of the nodes of one bus wait for a restart: whatever wrote them, they show in the transfers.
/// A restart that is heard ends it, and so does the old value, written again.
class OwedRestarts {
 public:
  /// What the node is: its data say which values wait. Node-ID and bitrate are left out: how they come into
  /// force is the matter of who changes them.
  void learn(std::uint8_t node, const drive::Profile& profile);
  /// `restarts`: how often the node was heard to restart.
  void on_exchange(const Exchange& exchange, std::uint32_t restarts);

  /// What waits since an earlier session, and the drive that it is kept of.
  void take_up(std::uint8_t node, std::vector<OwedValue> values, Identity of);
  /// It was restarted without being heard: nothing waits.
  void forget(std::uint8_t node);
  /// Whether the drive that is there is the one that earlier values are kept of; those of another are
  /// dropped.
  void settle_identity(std::uint8_t node, bool same);

  const std::vector<OwedValue>& values(std::uint8_t node, std::uint32_t restarts);
  /// The drive that the values are kept of, until it was seen to be the one that is there.
  const std::optional<Identity>& kept_of(std::uint8_t node) const { return nodes_[node].kept_of; }
  /// Whether the values have changed since the last call.
  bool take_changed(std::uint8_t node) { return std::exchange(nodes_[node].changed, false); }

 private:
  struct Node {
    const drive::Profile* profile = nullptr;
    std::optional<ObjectAddress> node_id, bitrate;
    std::vector<OwedValue> values;
    std::map<ObjectAddress, Bytes> seen;  ///< Values in force, as far as they were read.
    std::optional<Identity> kept_of;
    std::uint32_t restarts = 0;
    bool changed = false;
  };
  static bool waits(const Node& node, ObjectAddress object);
  static void settle(Node& node, std::uint32_t restarts);
  static void take(Node& node, ObjectAddress object, const Bytes& now, bool written);

  std::array<Node, 128> nodes_{};
};

}  // namespace servoctl::session
