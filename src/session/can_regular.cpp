// What a CAN network sends once a period.
#include <algorithm>

#include "canopen/nmt.hpp"
#include "session/can_network.hpp"

namespace servoctl::session {

using canopen::NmtState;

Result<void> CanNetwork::send_heartbeat(std::uint8_t node) {
  return send(canopen::heartbeat_frame(node, NmtState::operational));
}

Result<TimePoint> CanNetwork::send_heartbeat() {
  if (!heartbeat_) return kNever;
  const auto time = now();
  if (time < heartbeat_->next) return heartbeat_->next;
  heartbeat_->next = time + heartbeat_->period;
  if (const auto sent = bus_->send(canopen::heartbeat_frame(heartbeat_->node, NmtState::operational)); !sent)
    return fail(sent.error());
  return heartbeat_->next;
}

Result<TimePoint> CanNetwork::send_sync() {
  if (!sync_) return kNever;
  sync_->producer.on_time(now());
  if (const auto frame = sync_->producer.take_frame()) {
    if (const auto sent = bus_->send(*frame); !sent) return fail(sent.error());
    sync_->rhythm.add(now());
  }
  return sync_->producer.deadline();
}

TimePoint CanNetwork::keep_up() {
  const auto heartbeat = send_heartbeat();
  const auto sync = send_sync();
  // Who guards has to hear the answers.
  return std::min({guard_.deadline(), heartbeat.value_or(kNever), sync.value_or(kNever)});
}

}  // namespace servoctl::session
