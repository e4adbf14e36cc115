#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "session/ethercat_network.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// Of a node beyond the last of so many slaves.
Error no_slave_at(std::uint8_t node, std::size_t present);

/// Which of these nodes another master exchanges process data with. Errors of the network, and Errc::timeout
/// for a node that is no place on the ring.
Result<std::vector<std::uint8_t>> foreign_nodes(EtherCatNetwork& ring, std::span<const std::uint8_t> nodes);

/// Whether its statusword says that it is energised. Errors of the read.
Result<bool> has_power(Session& session, std::uint8_t node);

/// As EtherCatNetwork::request_state(), for a user: Errc::refused for a drive that is energised, unless it is
/// in that state already. A change of state would take its power away wherever its motor is.
Result<void> change_al_state(Session& session, EtherCatNetwork& ring, std::uint8_t node, NodeState target);

}  // namespace servoctl::session
