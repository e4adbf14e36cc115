#pragma once

#include <string>

#include "drive/profile.hpp"
#include "session/network.hpp"
#include "session/node_event.hpp"

namespace servoctl::show {

/// `boot-up`, `EMCY 0x8130 life guard or heartbeat error; error register 0x11 …`: an event of a node in one
/// line. `profile` may be null; it gives the family's own words for a code.
/// `network` gives its words for states and addresses; null: CAN's.
std::string event_text(const session::NodeEvent& event, const drive::Profile* profile, bool chinese,
                       const session::Network* network = nullptr);
/// The same with its node in front: `node 3: boot-up`.
Message notice_text(const session::NodeEvent& event, const drive::Profile* profile, bool chinese,
                    const session::Network* network = nullptr);

}  // namespace servoctl::show
