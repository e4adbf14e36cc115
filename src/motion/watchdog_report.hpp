#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drive/profile.hpp"
#include "motion/lost_master.hpp"
#include "session/session.hpp"

namespace servoctl::motion {

/// What a drive does by itself when its master disappears, as it is set now.
struct WatchdogReport {
  std::uint8_t node = 0;
  Stops stops = Stops::no;
  std::vector<std::string> noticed_by;  ///< `heartbeat of node 3, after 300 ms`
  std::optional<std::int64_t> option;   ///< 6007h, where it has one,
  std::string reaction;                 ///< and what that means; empty: not known.
  std::string nmt_state;                ///< What becomes of its NMT state (1029h:01); empty: not said.
  std::string fault;  ///< The fault 8130h of the family, heartbeat or life guarding; empty: it names none.
  std::vector<std::string> alarms;  ///< Panel texts of what the manual calls a lost communication.
  std::vector<std::string> remarks;
  bool assumed = false;  ///< The manual does not say what the motor does then.
};

/// Reads it, all nodes at the same time; a node that does not answer has an error instead.
std::vector<Result<WatchdogReport>> read_watchdogs(session::Session& session, const drive::Profile& profile,
                                                   std::span<const std::uint8_t> nodes);

}  // namespace servoctl::motion
