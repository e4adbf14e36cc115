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
  bool kept = false;     ///< It is known to outlive the restart.
  bool earlier = false;  ///< Kept of an earlier session, and not written since.
};

/// How often a node was heard to start.
struct Starts {
  std::uint32_t restarts = 0;
  std::uint32_t power_ups = 0;  ///< Those of them that no NMT command made.
};

/// Which values of the nodes of one bus wait for a restart: whatever wrote them, they show in the transfers.
/// A restart that is heard ends it, and so does the old value, written again.
class OwedRestarts {
 public:
  /// What the node is: its data say which values wait, among them its node-ID and bitrate. What was written
  /// before is judged as well, as far as the data say something of it. `registers`: the node has its number
  /// on a Modbus line.
  void learn(std::uint8_t node, const drive::Profile& profile, bool registers, Starts starts);
  /// Vendor objects that were written while nobody knew what the node is, or by the data of no family that
  /// say nothing of them, and that were not told by this before: whether they wait is not known.
  std::vector<ObjectAddress> take_unjudged(std::uint8_t node, Starts starts);
  void on_exchange(const Exchange& exchange, Starts starts);

  /// What waits since an earlier session, the drive that it is kept of, whether only power ends it, and where
  /// its node-ID is.
  void take_up(std::uint8_t node, std::vector<OwedValue> values, Identity of, bool by_power,
               std::optional<ObjectAddress> node_id);
  /// What another program has kept meanwhile.
  void add_from_others(std::uint8_t node, std::vector<OwedValue> values);
  /// It was restarted without being heard: nothing waits.
  void forget(std::uint8_t node);
  /// Whether the drive that is there is the one that earlier values are kept of; those of another are
  /// dropped.
  void settle_identity(std::uint8_t node, bool same);

  const std::vector<OwedValue>& values(std::uint8_t node, Starts starts);
  /// Where the node-ID of the node is, as far as it is known.
  const std::optional<ObjectAddress>& node_id_of(std::uint8_t node) const { return nodes_[node].node_id; }
  /// Whether a bitrate is among what waits.
  bool awaits_bitrate(std::uint8_t node) const;
  /// Whether an NMT reset is no restart of this drive (drive::NmtRules::Restart::power_cycle).
  bool ends_by_power(std::uint8_t node) const { return nodes_[node].by_power; }
  /// The drive that the values are kept of, until it was seen to be the one that is there.
  const std::optional<Identity>& kept_of(std::uint8_t node) const { return nodes_[node].kept_of; }
  /// Whether the values have changed since the last call.
  bool take_changed(std::uint8_t node) { return std::exchange(nodes_[node].changed, false); }

 private:
  struct Unjudged {
    OwedValue value;
    Starts since;
    bool reported = false;
  };
  struct Node {
    const drive::Profile* profile = nullptr;
    std::optional<ObjectAddress> node_id, bitrate, flash_switch;
    bool to_flash = false;  ///< Writes go to the memory that outlives power-off.
    std::vector<OwedValue> values;
    std::vector<Unjudged> unjudged;
    std::map<ObjectAddress, Bytes> seen;  ///< Values in force, as far as they were read.
    std::optional<Identity> kept_of;
    bool by_power = false;
    Starts starts;
    bool changed = false;
  };
  static od::Effect effect_of(const Node& node, ObjectAddress object);
  static bool waits(const Node& node, ObjectAddress object);
  static bool is_judged(const Node& node, ObjectAddress object);
  static bool has_restarted(const Node& node, Starts before, Starts now);
  static void settle(Node& node, Starts starts);
  static void note_storing(Node& node, const Exchange& exchange);
  static void forget_unjudged(Node& node, Starts starts);
  static void note_unjudged(Node& node, const Exchange& exchange, Starts starts);
  static void take(Node& node, ObjectAddress object, const Bytes& now, bool written);

  std::array<Node, 128> nodes_{};
};

}  // namespace servoctl::session
