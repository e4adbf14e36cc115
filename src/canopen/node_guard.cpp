#include "canopen/node_guard.hpp"

#include <algorithm>
#include <utility>

#include "canopen/cob_id.hpp"
#include "canopen/nmt.hpp"

namespace servoctl::canopen {

void NodeGuard::start(std::uint8_t node, GuardOptions options, TimePoint now) {
  nodes_[node] = {};
  nodes_[node].active = true;
  nodes_[node].options = options;
  nodes_[node].next = now;
  update_deadline();
}

void NodeGuard::stop(std::uint8_t node) {
  nodes_[node] = {};
  update_deadline();
}

TimePoint NodeGuard::lost_at(const Node& node) const {
  return node.asked && !node.lost ? *node.asked + node.options.life_factor * node.options.period : kNever;
}

void NodeGuard::on_frame(const can::Frame& frame, TimePoint now) {
  if (deadline_ == kNever) return;  // It guards nobody.
  const auto message = parse_error_control(frame);
  if (!message) return;
  auto& node = nodes_[message->node];
  if (!node.active) return;
  if (message->boot_up) {
    node.toggle.reset();
    return;
  }
  const std::uint8_t toggle = frame.data[0] >> 7U;
  if (node.toggle && toggle != *node.toggle) {
    node.wrong_toggle = true;
    return;
  }
  node.toggle = toggle ^ 1U;
  node.asked.reset();
  node.wrong_toggle = false;
  if (std::exchange(node.lost, false))
    events_.push_back({now, message->node, NodeEvent::GuardingBack{message->state}});
  update_deadline();
}

void NodeGuard::on_time(TimePoint now) {
  if (now < deadline_) return;
  for (auto& node : nodes_) {
    if (!node.active) continue;
    const auto id = static_cast<std::uint8_t>(&node - nodes_.data());
    if (now >= lost_at(node)) {
      node.lost = true;
      ++losses_[id];
      node.toggle.reset();
      events_.push_back({now, id, NodeEvent::GuardingLost{now - *node.asked, node.wrong_toggle}});
    }
    if (now < node.next) continue;
    if (!node.asked) node.asked = now;
    node.next = now + node.options.period;
    tx_.push_back(guarding_request(id));
  }
  update_deadline();
}

std::optional<can::Frame> NodeGuard::take_frame() {
  if (tx_.empty()) return std::nullopt;
  const auto frame = tx_.front();
  tx_.pop_front();
  return frame;
}

void NodeGuard::update_deadline() {
  deadline_ = kNever;
  for (const auto& node : nodes_)
    if (node.active) deadline_ = std::min({deadline_, node.next, lost_at(node)});
}

std::optional<NodeEvent> NodeGuard::take_event() {
  if (events_.empty()) return std::nullopt;
  const auto event = events_.front();
  events_.pop_front();
  return event;
}

}  // namespace servoctl::canopen
