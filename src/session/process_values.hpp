#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "drive/profile.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// What the node tells of these objects by itself from now on. On CAN its mapping is read first; where it
/// does not tell that, nothing comes, and everything is to be read. `profile` may be null.
std::unique_ptr<ProcessValues> process_values(Session& session, const drive::Profile* profile,
                                              std::uint8_t node, std::span<const ObjectAddress> objects);

/// Reads the mapping of these nodes, all at the same time, where Network::process_values() has to know it: on
/// CAN. Of one that does not tell it nothing comes. `profile` may be null.
void learn_pdos(Session& session, const drive::Profile* profile, std::span<const std::uint8_t> nodes);

}  // namespace servoctl::session
