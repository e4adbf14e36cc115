#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "base/object_address.hpp"
#include "can/frame.hpp"

namespace servoctl::canopen {

/// Counts what may have changed a node. If two of the same node are equal, what was learned of the node at
/// the first one still holds at the second one.
struct NodeEpoch {
  std::uint32_t boots = 0;   ///< Boot-up messages.
  std::uint32_t resets = 0;  ///< NMT commands "reset node" and "reset communication", of any master.
  std::uint32_t losses = 0;  ///< Times it was lost, by heartbeat or node guarding.
  std::uint32_t gaps = 0;    ///< Times the bus was away, so that nothing was heard.
  std::uint32_t writes = 0;  ///< Writes of a PDO parameter (1400h to 1BFFh) that any master began.
  ObjectAddress written;     ///< The last of them.

  bool operator==(const NodeEpoch&) const = default;
};

/// Why what was learned at `before` no longer holds, as words that follow "node 1": `has restarted`; empty if
/// it still holds.
std::string reason_between(const NodeEpoch& before, const NodeEpoch& now);

/// Keeps the epochs of all nodes, from frames in both directions. It does not know losses and gaps by itself.
/// Writes are those of the default SDO channels (CiA 301, 7.3.5). Performs no I/O.
class NodeEpochs {
 public:
  void on_frame(const can::Frame& frame);
  /// Nothing was heard for a time.
  void on_gap() { ++gaps_; }

  /// Of a node 1..127, without its losses.
  NodeEpoch of(std::uint8_t node) const;
  /// Whether a PDO parameter of the node was written since its last boot-up.
  bool is_written(std::uint8_t node) const { return nodes_[node & 0x7FU].is_written; }

 private:
  struct Node {
    NodeEpoch epoch;
    bool is_written = false;
  };
  std::array<Node, 128> nodes_{};
  std::uint32_t gaps_ = 0;
};

}  // namespace servoctl::canopen
