#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>

#include "base/time.hpp"
#include "can/frame.hpp"
#include "canopen/node_watch.hpp"

namespace servoctl::canopen {

/// How a node is guarded (CiA 301, 7.2.8.2.2.1).
struct GuardOptions {
  Duration period = std::chrono::seconds(1);  ///< Guard time, 100Ch: between two requests.
  std::uint32_t life_factor = 3;  ///< 100Dh: so many periods without an answer mean lost; at least 1.
};

/// The master's side of node guarding, for any number of nodes: asks each by a remote frame, checks the
/// toggle bit of the answers, and reports when a node is lost and when it is back. Performs no I/O and reads
/// no clock.
///
/// An answer whose toggle bit did not change is taken as not received, as the standard says; the first
/// answer, and the one after a boot-up, may carry either.
class NodeGuard {
 public:
  /// `node` 1..127. The first request is due at once.
  void start(std::uint8_t node, GuardOptions options, TimePoint now);
  void stop(std::uint8_t node);
  bool guards(std::uint8_t node) const { return nodes_[node].active; }
  /// It is guarded, and was lost.
  bool is_lost(std::uint8_t node) const { return nodes_[node].lost; }
  /// How often it was lost so far.
  std::uint32_t losses(std::uint8_t node) const { return losses_[node]; }

  void on_frame(const can::Frame& frame, TimePoint now);
  void on_time(TimePoint now);
  std::optional<can::Frame> take_frame();
  TimePoint deadline() const { return deadline_; }
  /// NodeEvent::GuardingLost and NodeEvent::GuardingBack.
  std::optional<NodeEvent> take_event();

 private:
  struct Node {
    bool active = false;
    bool lost = false;
    bool wrong_toggle = false;  ///< Since the last good answer.
    GuardOptions options;
    TimePoint next = kNever;             ///< When to ask again.
    std::optional<TimePoint> asked;      ///< The oldest request without an answer.
    std::optional<std::uint8_t> toggle;  ///< The bit the next answer must carry.
  };
  TimePoint lost_at(const Node& node) const;
  void update_deadline();

  std::array<Node, 128> nodes_{};
  std::array<std::uint32_t, 128> losses_{};
  TimePoint deadline_ = kNever;  ///< Of all nodes.
  std::deque<can::Frame> tx_;
  std::deque<NodeEvent> events_;
};

}  // namespace servoctl::canopen
