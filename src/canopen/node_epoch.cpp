#include "canopen/node_epoch.hpp"

#include "base/format.hpp"
#include "base/pdo_index.hpp"
#include "canopen/nmt.hpp"
#include "canopen/sdo_frame.hpp"

namespace servoctl::canopen {
namespace {

bool is_reset(NmtCommand command) {
  return command == NmtCommand::reset_node || command == NmtCommand::reset_communication;
}

}  // namespace

std::string reason_between(const NodeEpoch& before, const NodeEpoch& now) {
  if (before == now) return {};
  if (before.gaps != now.gaps) return "was not heard while the bus was away";
  if (before.boots != now.boots) return "has restarted";
  if (before.resets != now.resets) return "was reset (NMT)";
  if (before.losses != now.losses) return "was lost";
  return formatted("has another PDO setting: object {} was written", to_string(now.written));
}

void NodeEpochs::on_frame(const can::Frame& frame) {
  if (const auto write = sdo_write_request(frame)) {
    if (!pdo_at(write->object.index)) return;
    auto& node = nodes_[write->node];
    ++node.epoch.writes;
    node.epoch.written = write->object;
    node.is_written = true;
  } else if (const auto order = parse_nmt(frame); order && is_reset(order->command)) {
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (order->node == 0 || order->node == i) ++nodes_[i].epoch.resets;
  } else if (const auto message = parse_error_control(frame); message && message->boot_up) {
    auto& node = nodes_[message->node];
    ++node.epoch.boots;
    node.is_written = false;
  }
}

NodeEpoch NodeEpochs::of(std::uint8_t node) const {
  auto out = nodes_[node & 0x7FU].epoch;
  out.gaps = gaps_;
  return out;
}

}  // namespace servoctl::canopen
