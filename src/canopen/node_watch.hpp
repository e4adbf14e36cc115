#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <variant>

#include "base/time.hpp"
#include "can/frame.hpp"
#include "canopen/emergency_ids.hpp"
#include "canopen/nmt.hpp"

namespace servoctl::canopen {

/// Something a node sent unasked, or stopped sending.
struct NodeEvent {
  struct BootUp {};
  struct StateChange {
    NmtState state;
  };
  struct HeartbeatLost {
    Duration silence;
  };
  /// A guarded node has not answered in its life time; or its answers did not change their toggle bit.
  struct GuardingLost {
    Duration silence;
    bool wrong_toggle;
  };
  struct GuardingBack {
    NmtState state;
  };
  /// Two nodes answer under this number; what it was noticed by.
  struct Doubled {
    std::string by;
  };
  TimePoint time;
  std::uint8_t node = 0;
  std::variant<BootUp, StateChange, HeartbeatLost, Emergency, GuardingLost, GuardingBack, Doubled> what;
  std::uint32_t times = 1;  ///< How often in succession the node told the same emergency, or a boot-up.
};

/// Listens to boot-up, heartbeat and emergency messages of all nodes. Sees every frame, whatever a command
/// waits for.
///
/// The heartbeat period of a node is learned from its messages: the longest of at least two intervals, so
/// that an extra message at a change of state does not count as the period. A node that stays silent for
/// three periods (at least 100 ms longer than one) is reported as lost, once, until it is heard again.
class NodeWatch {
 public:
  void on_frame(const can::Frame& frame, TimePoint now);
  /// A frame that this program sends, or another master. Whoever writes 1017h gives the node another period,
  /// and an answer to a question by node guarding is no heartbeat: the period is learned anew.
  void on_sent(const can::Frame& frame, TimePoint now);
  void on_time(TimePoint now);
  TimePoint deadline() const { return deadline_; }

  std::optional<NodeEvent> take_event();

  /// State last heard from the node (1..127); empty until it was heard, and again after its heartbeat or the
  /// bus was lost, or a master commanded another one.
  std::optional<NmtState> state(std::uint8_t node) const {
    return nodes_[node].doubted ? std::nullopt : nodes_[node].state;
  }
  /// Boot-up messages heard from the node so far.
  std::uint32_t boots(std::uint8_t node) const { return nodes_[node].boots; }
  /// Those of them that do not follow an NMT reset of the communication, behind which the application goes on
  /// as it was (CiA 301, 7.3.2.2.1).
  std::uint32_t restarts(std::uint8_t node) const { return nodes_[node].restarts; }
  /// Those of them that no NMT command made: the power came back.
  std::uint32_t power_ups(std::uint8_t node) const { return nodes_[node].power_ups; }
  /// Heartbeats heard from the node so far, boot-up not counted.
  std::uint32_t heartbeats(std::uint8_t node) const { return nodes_[node].heartbeats; }
  /// How often its heartbeat was lost.
  std::uint32_t losses(std::uint8_t node) const { return nodes_[node].losses; }
  /// The longest interval seen between two heartbeats; zero until two were.
  Duration period(std::uint8_t node) const { return nodes_[node].period; }
  /// The last emergencies of the node since its boot-up or error reset, oldest first, at most eight.
  const std::deque<Emergency>& emergencies(std::uint8_t node) const {
    const auto found = emergencies_.find(node);
    return found == emergencies_.end() ? no_emergencies_ : found->second;
  }
  /// How many emergencies the node has sent that were no error reset.
  std::uint32_t alarms(std::uint8_t node) const { return nodes_[node].alarms; }
  /// The node's 1014h holds this: emergencies come under its CAN-ID as well.
  void learn_emergency_id(std::uint8_t node, std::uint32_t cob_id) { emergency_ids_.learn(node, cob_id); }
  /// The node answers a master's questions and sends nothing by itself: its silence means nothing.
  void set_guarded(std::uint8_t node, bool guarded);
  /// The node (0: every node) was sent an NMT command: the state of one that sends no heartbeat is unknown
  /// now.
  void on_command(std::uint8_t node);
  /// Nothing was heard until `now`, because the bus was away: silence counts from here.
  void on_gap(TimePoint now);
  /// Forgets the state and the period of the node, before it is sent a reset.
  void forget(std::uint8_t node);

 private:
  struct Node {
    std::optional<NmtState> state;
    bool doubted = false;  ///< It was heard before the heartbeat or the bus was lost.
    std::uint32_t boots = 0;
    std::uint32_t restarts = 0;
    std::uint32_t power_ups = 0;
    std::optional<NmtCommand> reset;  ///< It was told to, and has not booted up since.
    TimePoint reset_at{};
    std::uint32_t heartbeats = 0;
    std::uint32_t losses = 0;
    std::uint32_t alarms = 0;
    std::optional<TimePoint> last;  ///< Last heartbeat since boot-up or loss.
    Duration period{};              ///< Longest interval between two heartbeats.
    std::uint32_t intervals = 0;    ///< Intervals measured.
    bool lost = false;
    bool guarded = false;
    TimePoint deadline() const;
  };
  void on_emergency(const Emergency& emergency, TimePoint now);
  void on_error_control(const ErrorControl& message, TimePoint now);
  void forget_period(std::uint8_t node);
  void on_nmt(const NmtMessage& message, TimePoint now);

  void update_deadline();

  std::array<Node, 128> nodes_{};
  std::map<std::uint8_t, std::deque<Emergency>>
      emergencies_;  ///< An empty deque of each node would be 80 kB.
  std::deque<Emergency> no_emergencies_;
  EmergencyIds emergency_ids_;
  TimePoint deadline_ = kNever;  ///< Of all nodes; asked with every frame, changed by heartbeats only.
  std::deque<NodeEvent> events_;
};

}  // namespace servoctl::canopen
