#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "canopen/sdo_server.hpp"
#include "session/network.hpp"

namespace servoctl::session {

/// A node of a MemoryNetwork: any ObjectStore, and what it does beside answering, all of it optional.
struct MemoryNode {
  canopen::ObjectStore* objects = nullptr;
  NodeState state = NodeState::pre_operational;
  /// It is told to enter a state; false: it refuses, and tells a state error. Empty: it enters.
  std::function<bool(NodeState state)> on_state = {};
  /// Time goes on; when it wants to be told next.
  std::function<void(TimePoint now)> on_time = {};
  std::function<TimePoint()> deadline = {};
  /// What it tells by itself.
  std::function<std::optional<NodeEvent::What>()> take_event = {};
  bool silent = false;
  int lost_answers = 0;  ///< So many requests are carried out and not answered.
};

/// What the last exchange brought, each value once.
class MemoryProcessValues final : public ProcessValues {
 public:
  /// Values are exchanged so often, of nodes that are at least safe-operational.
  static constexpr Duration kCycle = std::chrono::milliseconds(4);

  /// `node` may be null: nobody is there. Both outlive it.
  MemoryProcessValues(const MemoryNode* node, const TimePoint& now, std::span<const ObjectAddress> objects)
      : node_(node), now_(&now) {
    for (const auto object : objects) taken_[object] = TimePoint::min();
  }
  std::optional<Bytes> take(ObjectAddress object, TimePoint since) override {
    const auto known = taken_.find(object);
    const TimePoint exchanged(now_->time_since_epoch() / kCycle * kCycle);
    const bool exchanges = node_ != nullptr && (node_->state == NodeState::safe_operational ||
                                                node_->state == NodeState::operational);
    if (!exchanges || known == taken_.end() || exchanged < since || exchanged <= known->second)
      return std::nullopt;
    known->second = exchanged;
    Bytes out;
    return node_->objects->read(object, out) == 0 ? std::optional(std::move(out)) : std::nullopt;
  }
  bool carries(ObjectAddress object) const override { return taken_.count(object) != 0; }
  void keep_all() override {}
  std::vector<Arrival> take_all() override {
    std::vector<Arrival> out;
    for (const auto& [object, time] : taken_)
      if (auto value = take(object, TimePoint::min())) out.push_back({object, std::move(*value), time});
    return out;
  }

 private:
  const MemoryNode* node_;
  const TimePoint* now_;
  std::map<ObjectAddress, TimePoint> taken_;
};

}  // namespace servoctl::session
