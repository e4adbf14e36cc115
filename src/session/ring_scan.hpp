#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "session/ethercat_network.hpp"
#include "session/identity.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// What stands at one place of an EtherCAT ring.
struct RingSlave {
  EtherCatNetwork::Seen seen;
  /// By its SII; where its objects were read, by these.
  Identity identity;
  bool has_objects = false;         ///< Its objects were read.
  std::vector<std::string> doubts;  ///< What is wrong with its SII, a phrase each.
};

/// What a look at a ring finds.
struct RingScan {
  std::size_t count = 0;          ///< Slaves on the wire; the first 127 are nodes.
  std::vector<RingSlave> slaves;  ///< By position: the first is node 1.

  /// The first node that another master exchanges process data with; 0: there is none.
  std::uint8_t foreign() const;
};

/// Looks at the ring: registers and SII of every slave. No state is changed and no address given. Objects
/// (1000h, 1008h to 100Ah, 1018h) are read only of slaves in PRE-OP or above, and only where every slave has
/// the address that servoctl gives it. Nothing but registers is read where another master works. Errc::bus
/// when frames do not come back or nobody is there.
Result<RingScan> scan_ring(Session& session, EtherCatNetwork& ring);

}  // namespace servoctl::session
