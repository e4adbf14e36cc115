#pragma once

#include <string>
#include <vector>

#include "base/result.hpp"

namespace servoctl::ethernet {

/// The interfaces of this machine that a cable can be plugged into, up or down, in alphabetical order.
std::vector<std::string> ethernet_interfaces();

/// The index of an interface that can carry EtherCAT and is up. Errc::usage for a name that no interface can
/// have; Errc::bus, each with its own words and what mends it, for one that is missing, is no Ethernet (CAN,
/// loopback, wireless), or is down.
Result<int> interface_index(const std::string& name);

/// Whether a cable is plugged in, with somebody at its other end.
bool has_link(const std::string& name);

/// Errc::bus.
tl::unexpected<Error> no_link(const std::string& name);
/// Errc::bus: this program may not send Ethernet frames; the hint is the command that lets it.
tl::unexpected<Error> no_right(const std::string& name);
/// Errc::bus: what was open failed with this value of errno.
tl::unexpected<Error> interface_lost(const std::string& name, int error);
/// Errc::bus: it could not be opened.
tl::unexpected<Error> interface_cannot_open(const std::string& name, int error);

}  // namespace servoctl::ethernet
