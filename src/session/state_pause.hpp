#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "session/session.hpp"

namespace servoctl::session {

/// The state of a node, by what it tells next by itself (CANopen: its heartbeat), or by the question for it
/// where asking once sets nothing off (no life time of node guarding is set) unless `by_question` forbids
/// that; empty when neither tells it. Errors of the network, and Errc::interrupted.
Result<std::optional<NodeState>> ask_state(Session& session, std::uint8_t node, bool by_question = true);

/// Takes one node out of Operational and puts it back.
class StatePause {
 public:
  StatePause(Session& session, std::uint8_t node) : session_(&session), node_(node) {}
  StatePause(const StatePause&) = delete;
  StatePause& operator=(const StatePause&) = delete;
  ~StatePause() { (void)leave(true); }

  /// Tells the node to enter Pre-operational, unless it is there.
  Result<void> enter();
  /// Starts the node again if it was Operational; one whose state was not known, and any with `put_back`
  /// false, stays Pre-operational, which notices() says.
  Result<void> leave(bool put_back);

  /// What it did meanwhile shows the state that it was in, where it did not tell that itself.
  void note_before(NodeState state) {
    if (!before_) before_ = state;
  }

  bool entered() const { return entered_; }
  const std::vector<Message>& notices() const { return notices_; }

 private:
  Session* session_;
  std::uint8_t node_;
  bool entered_ = false;
  std::optional<NodeState> before_;
  std::vector<Message> notices_;
};

}  // namespace servoctl::session
