#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/object_address.hpp"
#include "drive/cia402.hpp"
#include "drive/rules.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// How long the bus is listened to before a node-ID counts as free: masters and nodes that only send
/// heartbeats send one at least so often.
inline constexpr Duration kAddressListening = std::chrono::milliseconds(1500);

/// How it is found out who uses a node-ID.
struct AddressLook {
  Duration listening = kAddressListening;
  /// Those that neither answer nor are heard are asked by node guarding, which reaches one that is stopped
  /// (NMT): a node that guards its master's life begins to do so. Not in a dry run.
  bool guards = true;
};

/// Which of these node-IDs somebody uses, and what shows it: `it answers`, `it sends heartbeats`. All are
/// asked once at the same time, and the bus is listened to. Errors of the bus. On a network without node-IDs
/// of its own nobody uses any.
Result<std::map<std::uint8_t, std::string>> nodes_in_use(Session& session,
                                                         std::span<const std::uint8_t> nodes,
                                                         const AddressLook& look = {});

/// Whether nodes can be asked by node guarding: not where the bus carries no remote frames.
bool guards_nodes(Session& session);

/// Those that use the bus beside `nodes`, as nodes_in_use() finds them; servoctl's own heartbeat is nobody.
Result<std::vector<std::uint8_t>> nodes_beside(Session& session, std::span<const std::uint8_t> nodes,
                                               const AddressLook& look = {});

/// What showed that two nodes have this number, in words; empty: nothing. Of no node-ID: empty.
std::string sharers_of(Session& session, std::uint8_t node);

/// Whether the drive has power on its motor, and where two were noticed under this number, whether either
/// has; one that has no statusword has none. Else as Session::upload().
Result<bool> is_energised(Session& session, std::uint8_t node);
/// The same of any axis of the node: also of further_axes().
Result<bool> is_any_axis_energised(Session& session, std::uint8_t node);

/// An axis of a node beside its first.
struct FurtherAxis {
  unsigned number;  ///< 2 to drive::kMostAxes.
  std::uint16_t statusword;
};
struct FurtherAxes {
  std::vector<FurtherAxis> axes;
  std::optional<Error> failure;  ///< Why no more were asked for.
};
/// The axes 2 to drive::kMostAxes (CiA 402-2: objects 800h higher each) that have a statusword; a number
/// between them may be missing, as that of an empty slot. None where 1000h does not say that the node is a
/// drive, nor of a node that takes a request for a missing object for an alarm; where an EMCY follows the
/// refusal of one, no further one is asked for. The failures are those of Session::upload().
FurtherAxes further_axes(Session& session, std::uint8_t node);

/// Sends the node the NMT command that puts a new address in force; nothing for a power cycle. What was heard
/// of it is forgotten: another may answer under its number from now on.
Result<void> restart_node(Session& session, std::uint8_t node, drive::NmtRules::Restart how);
/// The frame that restart_node() sends, as `--dry-run` shows it: `000#8103`; empty for a power cycle.
std::string restart_frame(std::uint8_t node, drive::NmtRules::Restart how);

/// What was known of the node under this number holds no longer.
void forget_node(Session& session, std::uint8_t node);

/// Waits until one of the two tells its boot-up, or until the deadline; asks `to` for an answer every two
/// seconds beside it, as a boot-up message may be lost. Errc::bus and Errc::interrupted.
Result<void> wait_for_boot(Session& session, std::uint8_t from, std::uint8_t to, TimePoint deadline);

}  // namespace servoctl::session
