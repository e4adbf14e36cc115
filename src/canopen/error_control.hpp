#pragma once

#include <cstdint>
#include <optional>

#include "base/time.hpp"
#include "can/frame.hpp"
#include "canopen/nmt.hpp"

namespace servoctl::canopen {

/// The node that an entry of 1016h with this value watches (CiA 301, 7.5.2.19): bits 23-16, with a time in ms
/// in bits 15-0. 0, for none, where either is zero or the number is no node-ID.
std::uint8_t watched_node(std::uint32_t consumer_entry);

/// The error control services of an NMT slave (CiA 301, 7.2.8.2.2): boot-up, heartbeat, and answers to node
/// guarding with life guarding. Performs no I/O and reads no clock.
class ErrorControlSlave {
 public:
  explicit ErrorControlSlave(std::uint8_t node) : node_(node) {}

  /// The node has initialised: boot-up is sent, the toggle bit begins at 0.
  void boot(NmtState state, TimePoint now);
  /// The node restarts and says nothing until it has booted.
  void stop();
  void set_state(NmtState state) { state_ = state; }
  /// 1017h. Zero switches the heartbeat off; while it is on, node guarding is not answered.
  void set_heartbeat(Duration period, TimePoint now);
  /// 100Ch and 100Dh. Life guarding begins with the first request of the master; zero switches it off.
  void set_life_time(Duration guard_time, std::uint32_t factor);

  void on_frame(const can::Frame& frame, TimePoint now);
  void on_time(TimePoint now);
  std::optional<can::Frame> take_frame();
  TimePoint deadline() const;
  /// True once after the master has not asked for the life time: a life guarding event.
  bool take_life_lost();

 private:
  std::uint8_t node_;
  NmtState state_ = NmtState::initialising;
  Duration heartbeat_{};
  TimePoint next_heartbeat_ = kNever;
  Duration life_time_{};
  TimePoint life_ends_ = kNever;
  bool life_lost_ = false;
  std::uint8_t toggle_ = 0;
  std::optional<can::Frame> tx_;
};

}  // namespace servoctl::canopen
