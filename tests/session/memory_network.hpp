#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "canopen/sdo_abort.hpp"
#include "canopen/sdo_server.hpp"
#include "memory_process_values.hpp"
#include "session/network.hpp"

namespace servoctl::session {

/// A network without a wire, frames or CAN: objects in memory, in virtual time. What runs on it knows nothing
/// of CAN.
class MemoryNetwork final : public Network, private NodeRecords {
 public:
  /// From a request to its answer.
  static constexpr Duration kAnswer = std::chrono::milliseconds(1);

  MemoryNode& add(std::uint8_t node, canopen::ObjectStore& objects) {
    auto& place = nodes_[node];
    place.objects = &objects;
    return place;
  }
  /// Notes what a node tells, as any network does that hears it.
  void tell(std::uint8_t node, NodeEvent::What what) {
    if (std::holds_alternative<NodeEvent::BootUp>(what)) {
      ++told_[node].boots;
      told_[node].state = NodeState::pre_operational;
    }
    if (const auto* change = std::get_if<NodeEvent::StateChange>(&what)) {
      ++told_[node].heartbeats;
      told_[node].state = change->state;
    }
    if (const auto* emergency = std::get_if<canopen::Emergency>(&what)) {
      told_[node].emergencies.push_back(*emergency);
      if (!emergency->is_reset()) ++told_[node].alarms;
    }
    events_.push_back({now_, node, std::move(what)});
  }
  /// While it is set, nothing goes through.
  bool lost = false;

  TimePoint now() const override { return now_; }
  TimePoint stepped_at() const override { return now_; }
  TimePoint next_event() const override {
    auto next = kNever;
    for (const auto& answer : due_) next = std::min(next, answer.time);
    for (const auto& [id, node] : nodes_)
      if (node.deadline) next = std::min(next, node.deadline());
    return next;
  }
  Result<bool> step(TimePoint deadline) override;
  Result<void> recover(TimePoint deadline) override {
    now_ = std::max(now_, deadline);
    return lost ? Result<void>(fail(gone())) : Result<void>();
  }
  std::unique_ptr<ObjectChannel> object_channel(std::uint8_t node, Duration timeout) override;
  const NodeRecords& records() const override { return *this; }
  std::optional<NodeEvent> take_event() override {
    if (events_.empty()) return std::nullopt;
    auto out = std::move(events_.front());
    events_.pop_front();
    return out;
  }
  Result<void> request_state(std::uint8_t id, NodeState state) override {
    if (lost) return fail(gone());
    const auto found = nodes_.find(id);
    if (found == nodes_.end()) return {};
    auto& node = found->second;
    if (node.on_state && !node.on_state(state)) {
      tell(id, NodeEvent::StateError{0x001B, "sync manager watchdog"});
      return {};
    }
    node.state = state;
    tell(id, NodeEvent::StateChange{state});
    return {};
  }
  Result<void> ask_state(std::uint8_t id) override {
    if (const auto found = nodes_.find(id); found != nodes_.end())
      tell(id, NodeEvent::StateChange{found->second.state});
    return {};
  }
  void doubt_state(std::uint8_t node) override { told_[node].state.reset(); }
  bool carries(LifeSign::Kind) const override { return false; }
  Result<void> arm_watchdog(std::uint8_t, const LifeSign&) override {
    return fail(Errc::usage, "memory: there are no signs of life here");
  }
  void disarm_watchdog(std::uint8_t) override {}
  void send_last_word(std::uint8_t id, ObjectAddress object, std::uint16_t value) noexcept override {
    const std::uint8_t bytes[] = {static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value >> 8U)};
    if (auto* node = node_at(id)) (void)node->objects->write(object, bytes);
  }
  std::unique_ptr<ProcessValues> process_values(std::uint8_t node,
                                                std::span<const ObjectAddress> objects) override;

 private:
  class Channel;
  struct Due {
    TimePoint time;
    Channel* channel;
  };
  struct Told {
    std::optional<NodeState> state;
    std::uint32_t boots = 0;
    std::uint32_t heartbeats = 0;
    std::deque<canopen::Emergency> emergencies;
    std::uint32_t alarms = 0;
  };

  static Error gone() { return fail(Errc::bus, "memory: the network is lost", "wait for it").value(); }
  MemoryNode* node_at(std::uint8_t node) {
    const auto found = nodes_.find(node);
    return found == nodes_.end() ? nullptr : &found->second;
  }
  const Told& told(std::uint8_t node) const {
    static const Told kNothing;
    const auto found = told_.find(node);
    return found == told_.end() ? kNothing : found->second;
  }
  void let_nodes_go_on();

  std::optional<NodeState> state(std::uint8_t node) const override { return told(node).state; }
  std::uint32_t boots(std::uint8_t node) const override { return told(node).boots; }
  std::uint32_t heartbeats(std::uint8_t node) const override { return told(node).heartbeats; }
  const std::deque<canopen::Emergency>& emergencies(std::uint8_t node) const override {
    return told(node).emergencies;
  }
  std::uint32_t alarms(std::uint8_t node) const override { return told(node).alarms; }

  TimePoint now_{std::chrono::seconds(1)};
  std::map<std::uint8_t, MemoryNode> nodes_;
  std::map<std::uint8_t, Told> told_;
  std::vector<Due> due_;
  std::deque<NodeEvent> events_;
};

class MemoryNetwork::Channel final : public ObjectChannel {
 public:
  Channel(MemoryNetwork& network, std::uint8_t node, Duration timeout)
      : network_(&network), node_(node), timeout_(timeout) {}
  ~Channel() override { forget(); }

  void set_timeout(Duration timeout) override { timeout_ = timeout; }
  void start_upload(ObjectAddress object, TimePoint now, canopen::Transfer, std::size_t) override {
    start(object, std::nullopt, now);
  }
  void start_download(ObjectAddress object, Bytes data, TimePoint now, canopen::Transfer) override {
    start(object, std::move(data), now);
  }
  Result<void> on_time(TimePoint now) override {
    if (!busy()) return {};
    if (std::exchange(unsent_, false)) {
      if (network_->lost) return fail(gone());
      network_->due_.push_back({network_->now_ + kAnswer, this});
    }
    if (now >= deadline_) end(fail(error(Errc::timeout, "no answer")));
    return {};
  }
  std::optional<Result<Bytes>> take_result() override { return std::exchange(result_, std::nullopt); }
  bool busy() const override { return deadline_ != kNever; }
  TimePoint deadline() const override { return deadline_; }
  std::size_t transferred() const override { return data_ ? data_->size() : 0; }
  std::optional<std::size_t> total() const override { return std::nullopt; }

  /// The request reaches the node.
  void arrive() {
    auto* node = network_->node_at(node_);
    if (node == nullptr || node->silent || node->state == NodeState::stopped) return;
    Bytes out;
    const auto code = data_ ? node->objects->write(object_, *data_) : node->objects->read(object_, out);
    if (node->lost_answers > 0) {
      --node->lost_answers;
      return;
    }
    if (code == 0) return end(std::move(out));
    auto refused = error(Errc::sdo_abort, "refused: " + std::string(canopen::sdo_abort_text(code)));
    refused.abort_code = code;
    end(fail(std::move(refused)));
  }

 private:
  void start(ObjectAddress object, std::optional<Bytes> data, TimePoint now) {
    object_ = object;
    data_ = std::move(data);
    unsent_ = true;
    deadline_ = now + timeout_;
  }
  void end(Result<Bytes> result) {
    result_ = std::move(result);
    deadline_ = kNever;
    forget();
  }
  void forget() {
    std::erase_if(network_->due_, [&](const Due& due) { return due.channel == this; });
  }
  Error error(Errc code, const std::string& what) const {
    Error out;
    out.code = code;
    out.message = "node " + std::to_string(node_) + ", object " + to_string(object_) + ": " + what;
    out.node = node_;
    out.object = object_;
    return out;
  }

  MemoryNetwork* network_;
  std::uint8_t node_;
  Duration timeout_;
  ObjectAddress object_;
  std::optional<Bytes> data_;
  bool unsent_ = false;
  TimePoint deadline_ = kNever;
  std::optional<Result<Bytes>> result_;
};

inline std::unique_ptr<ObjectChannel> MemoryNetwork::object_channel(std::uint8_t node, Duration timeout) {
  return std::make_unique<Channel>(*this, node, timeout);
}

inline std::unique_ptr<ProcessValues> MemoryNetwork::process_values(std::uint8_t node,
                                                                    std::span<const ObjectAddress> objects) {
  return std::make_unique<MemoryProcessValues>(node_at(node), now_, objects);
}

inline void MemoryNetwork::let_nodes_go_on() {
  for (auto& [id, node] : nodes_) {
    if (node.on_time) node.on_time(now_);
    while (node.take_event) {
      auto what = node.take_event();
      if (!what) break;
      tell(id, std::move(*what));
    }
  }
}

inline Result<bool> MemoryNetwork::step(TimePoint deadline) {
  if (lost) return fail(gone());
  const auto next = next_event();
  now_ = std::max(now_, std::min(deadline, next));
  let_nodes_go_on();
  const auto due = std::find_if(due_.begin(), due_.end(), [&](const Due& each) { return each.time <= now_; });
  if (due == due_.end()) return false;
  auto* channel = due->channel;
  due_.erase(due);
  channel->arrive();
  return true;
}

}  // namespace servoctl::session
