#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "canopen/node_epoch.hpp"
#include "drive/profile.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// What the node tells of these objects by itself from now on. On CAN its mapping is read first; where it
/// does not tell that, nothing comes, and everything is to be read. `profile` may be null.
std::unique_ptr<ProcessValues> process_values(Session& session, const drive::Profile* profile,
                                              std::uint8_t node, std::span<const ObjectAddress> objects);

/// Reads the mapping of these nodes, all at the same time, where Network::process_values() has to know it: on
/// CAN. Of one that does not tell it nothing comes. `profile` may be null. Whether all have told it.
bool learn_pdos(Session& session, const drive::Profile* profile, std::span<const std::uint8_t> nodes);

/// How long what was learned of a node holds: until it restarts or is reset, is lost, another PDO setting is
/// written to it, or the bus is away.
class Lifetime {
 public:
  /// After the last of these the node is left alone for so long: whoever resets a node sets it up afterwards.
  static constexpr Duration kSettling = std::chrono::seconds(1);
  /// Between two tries to ask a node that does not answer.
  static constexpr Duration kAgain = std::chrono::seconds(5);

  /// Begins now, before anything is learned.
  Lifetime(Session& session, std::uint8_t node);

  /// Why it has ended, as words that follow "node 1": `has restarted`; empty until then.
  std::string ended() const;
  /// It has ended, nothing more came for kSettling, and whoever was told so before is not told again for
  /// kAgain: time to ask the node anew.
  bool is_to_renew();

 private:
  canopen::NodeEpoch epoch() const;

  Session* session_;
  std::uint8_t node_;
  canopen::NodeEpoch learned_;
  canopen::NodeEpoch seen_;  ///< By the last is_to_renew().
  TimePoint due_ = kNever;
};

}  // namespace servoctl::session
