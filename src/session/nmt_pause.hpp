#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "canopen/nmt.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// The NMT state of a node, by its next heartbeat, or by node guarding where asking once sets nothing off (no
/// life time is set) unless `by_guarding` forbids that remote frame; empty when neither tells it. Errors of
/// the bus, and Errc::interrupted.
Result<std::optional<canopen::NmtState>> ask_nmt_state(Session& session, std::uint8_t node,
                                                       bool by_guarding = true);

/// Takes one node out of Operational and puts it back.
class NmtPause {
 public:
  NmtPause(Session& session, std::uint8_t node) : session_(&session), node_(node) {}
  NmtPause(const NmtPause&) = delete;
  NmtPause& operator=(const NmtPause&) = delete;
  ~NmtPause() { (void)leave(true); }

  /// Tells the node to enter Pre-operational, unless it is there.
  Result<void> enter();
  /// Starts the node again if it was Operational; one whose state was not known, and any with `put_back`
  /// false, stays Pre-operational, which notices() says.
  Result<void> leave(bool put_back);

  bool entered() const { return entered_; }
  const std::vector<std::string>& notices() const { return notices_; }

 private:
  Session* session_;
  std::uint8_t node_;
  bool entered_ = false;
  std::optional<canopen::NmtState> before_;
  std::vector<std::string> notices_;
};

}  // namespace servoctl::session
