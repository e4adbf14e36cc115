#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "session/session.hpp"

namespace servoctl::session {

/// What was heard of one node so far, and whether somebody is there.
struct NodeLife {
  std::uint8_t node = 0;
  std::uint32_t boots = 0;       ///< Boot-up messages and
  std::uint32_t heartbeats = 0;  ///< heartbeats, when it was looked at.
  bool alive = false;
  bool answers = false;  ///< An SDO request.
  bool doubled = false;  ///< Two drives have the node-ID: what one of them does says nothing of the other.
};

/// From now on.
std::vector<NodeLife> look_from_now(const Session& session, std::span<const std::uint8_t> nodes);

/// Asks all for 1000h once, at the same time: in pre-operational and operational a node answers an SDO
/// request (CiA 301, 7.3.2.2.1). Errc::bus and Errc::interrupted.
Result<void> ask_who_answers(Session& session, std::span<NodeLife> nodes);

/// Asks until all have answered, at most for `patience`. Errors as there.
Result<void> wait_for_answers(Session& session, std::span<NodeLife> nodes, Duration patience);

/// Asks them, and hears whether two drives have one node-ID, as far as they are not stopped: what starts or
/// resets a node goes to one drive. Errc::refused, and errors of the bus.
Result<void> hold_single(Session& session, std::span<NodeLife> nodes);

/// After a start or a reset: asks all, and hears whether two drives answer now: one of them, or both, may
/// have been stopped before it. Over a gateway, which lets no frame be heard, it asks only. Errors of the
/// bus.
Result<void> look_for_second(Session& session, std::span<NodeLife> nodes);

/// Waits until of each that is not known to be alive a boot-up, a heartbeat or an answer to node guarding was
/// heard, at most for `patience`, or for the heartbeat period of a node where that is longer. Errors of the
/// bus.
Result<void> hear_who_lives(Session& session, std::span<NodeLife> nodes, Duration patience);

/// 1017h of a node.
struct HeartbeatPeriod {
  std::uint8_t node = 0;
  Duration period{};
};

/// Waits until the state of each that sends heartbeats was heard: for one and a half of the longest period, 3
/// s at most. Errors of the bus.
Result<void> hear_states(Session& session, std::span<const HeartbeatPeriod> periods);

/// How heartbeats of nodes come.
struct Heartbeats {
  Duration longest{};                ///< Of those that say it.
  std::vector<std::uint8_t> silent;  ///< Say that they send none.
};

/// Reads 1017h of all nodes; one that is stopped answers no SDO, and may send heartbeats all the same.
Heartbeats read_heartbeats(Session& session, std::span<const std::uint8_t> nodes);

}  // namespace servoctl::session
