#include "canopen/node_watch.hpp"

#include <algorithm>
#include <utility>

#include "canopen/cob_id.hpp"
#include "canopen/sdo_frame.hpp"

namespace servoctl::canopen {

namespace {

/// A boot-up that comes later is not that of a reset command.
constexpr Duration kLongestStart = std::chrono::seconds(10);

constexpr std::size_t kMostEmergencies = 8;
constexpr ObjectAddress kHeartbeatTime{0x1017, 0};
/// Command specifier of an initiate download request, in the upper three bits of byte 0 (CiA 301, 7.2.4.3.3).
constexpr std::uint8_t kInitiateDownload = 1;

bool writes_heartbeat_time(const can::Frame& frame) {
  return !frame.extended && !frame.remote && !frame.error && frame.size == 8 && frame.id > kSdoRequest &&
         frame.id <= kSdoRequest + kLastNode && frame.data[0] >> 5U == kInitiateDownload &&
         sdo_object(frame) == kHeartbeatTime;
}

/// What answers it is no heartbeat, after which another one comes.
bool asks_for_state(const can::Frame& frame) {
  return frame.remote && !frame.extended && !frame.error && frame.id > kErrorControl &&
         frame.id <= kErrorControl + kLastNode;
}

std::uint8_t watched_node_of(const can::Frame& frame) { return static_cast<std::uint8_t>(frame.id & 0x7FU); }

}  // namespace

TimePoint NodeWatch::Node::deadline() const {
  if (guarded || intervals < 2) return kNever;
  return *last + std::max<Duration>(3 * period, period + std::chrono::milliseconds(100));
}

void NodeWatch::on_frame(const can::Frame& frame, TimePoint now) {
  if (const auto emergency = emergency_ids_.parse(frame)) return on_emergency(*emergency, now);
  if (const auto message = parse_error_control(frame)) {
    on_error_control(*message, now);
    update_deadline();
  }
  if (const auto order = parse_nmt(frame)) on_command(order->node);  // By another master, as what follows.
  on_sent(frame, now);
}

void NodeWatch::on_nmt(const NmtMessage& message, TimePoint now) {
  if (message.command != NmtCommand::reset_communication && message.command != NmtCommand::reset_node) return;
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    if (message.node == 0 || i == message.node) {
      nodes_[i].reset = message.command;
      nodes_[i].reset_at = now;
    }
}

void NodeWatch::on_sent(const can::Frame& frame, TimePoint now) {
  if (const auto message = parse_nmt(frame)) on_nmt(*message, now);
  const bool asks_once = asks_for_state(frame) && !nodes_[watched_node_of(frame)].guarded;
  if (asks_once || writes_heartbeat_time(frame)) forget_period(watched_node_of(frame));
}

void NodeWatch::forget_period(std::uint8_t node) {
  nodes_[node].last.reset();
  nodes_[node].intervals = 0;
  nodes_[node].period = Duration::zero();
  update_deadline();
}

/// A node that repeats itself while nobody takes its events is counted, not listed.
void NodeWatch::on_emergency(const Emergency& emergency, TimePoint now) {
  auto& recent = emergencies_[emergency.node];
  if (emergency.is_reset()) {
    recent.clear();
  } else {
    recent.push_back(emergency);
    ++nodes_[emergency.node].alarms;
  }
  if (recent.size() > kMostEmergencies) recent.pop_front();
  const auto last = std::find_if(events_.rbegin(), events_.rend(),
                                 [&](const NodeEvent& event) { return event.node == emergency.node; });
  const auto* same = last == events_.rend() ? nullptr : std::get_if<Emergency>(&last->what);
  if (same != nullptr && *same == emergency)
    ++last->times;
  else
    events_.push_back({now, emergency.node, emergency});
}

void NodeWatch::on_error_control(const ErrorControl& message, TimePoint now) {
  auto& node = nodes_[message.node];
  node.doubted = false;
  if (message.boot_up) {
    ++node.boots;
    auto reset = std::exchange(node.reset, std::nullopt);
    if (now > node.reset_at + kLongestStart) reset.reset();
    if (reset != NmtCommand::reset_communication) ++node.restarts;
    if (!reset) ++node.power_ups;
    emergency_ids_.on_boot_up(message.node);
    node.state = NmtState::pre_operational;  // CiA 301, 7.3.2.2.1: a node enters it by itself after boot-up.
    node.last.reset();
    node.intervals = 0;
    node.lost = false;
    emergencies_.erase(message.node);
    const auto told = std::find_if(events_.rbegin(), events_.rend(),
                                   [&](const NodeEvent& event) { return event.node == message.node; });
    if (told != events_.rend() && std::holds_alternative<NodeEvent::BootUp>(told->what))
      ++told->times;
    else
      events_.push_back({now, message.node, NodeEvent::BootUp{}});
    return;
  }
  if (node.last)
    node.period = std::max(node.intervals++ == 0 ? Duration::zero() : node.period, now - *node.last);
  if (node.lost || (node.state && *node.state != message.state))
    events_.push_back({now, message.node, NodeEvent::StateChange{message.state}});
  node.lost = false;
  node.state = message.state;
  node.last = now;
  ++node.heartbeats;
}

void NodeWatch::on_time(TimePoint now) {
  if (now < deadline_) return;
  for (auto& node : nodes_) {
    if (now < node.deadline()) continue;
    node.lost = true;
    node.doubted = true;
    ++node.losses;
    const auto id = static_cast<std::uint8_t>(&node - nodes_.data());
    events_.push_back({now, id, NodeEvent::HeartbeatLost{now - *node.last}});
    node.last.reset();
    node.intervals = 0;
  }
  update_deadline();
}

void NodeWatch::update_deadline() {
  deadline_ = kNever;
  for (const auto& node : nodes_) deadline_ = std::min(deadline_, node.deadline());
}

void NodeWatch::on_gap(TimePoint now) {
  for (auto& node : nodes_) {
    node.doubted = true;
    if (node.last) node.last = now;
  }
  update_deadline();
}

void NodeWatch::set_guarded(std::uint8_t node, bool guarded) {
  nodes_[node].guarded = guarded;
  update_deadline();
}

std::optional<NodeEvent> NodeWatch::take_event() {
  if (events_.empty()) return std::nullopt;
  auto event = events_.front();
  events_.pop_front();
  return event;
}

void NodeWatch::on_command(std::uint8_t node) {
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    if ((node == 0 || i == node) && !nodes_[i].last) nodes_[i].state.reset();
}

void NodeWatch::forget(std::uint8_t node) {
  const auto before = nodes_[node];
  nodes_[node] = {};
  emergencies_.erase(node);
  nodes_[node].boots = before.boots;
  nodes_[node].losses = before.losses;
  nodes_[node].alarms = before.alarms;
  nodes_[node].restarts = before.restarts;
  nodes_[node].power_ups = before.power_ups;
  nodes_[node].reset = before.reset;
  nodes_[node].reset_at = before.reset_at;
  nodes_[node].guarded = before.guarded;
  update_deadline();
}

}  // namespace servoctl::canopen
