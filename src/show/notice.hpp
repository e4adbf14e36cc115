#pragma once

#include <string>

#include "drive/profile.hpp"
#include "session/node_event.hpp"

namespace servoctl::show {

/// `node 3: boot-up`, `node 3: EMCY 0x8130 life guard or heartbeat error, error register 0x11 …`: what a node
/// told, in one line. `profile` may be null; it gives the family's own words for a code.
std::string notice_text(const session::NodeEvent& event, const drive::Profile* profile, bool chinese);

}  // namespace servoctl::show
