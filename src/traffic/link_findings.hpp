#pragma once

#include <optional>
#include <string>
#include <vector>

#include "can/link.hpp"
#include "traffic/bus_picture.hpp"
#include "traffic/finding.hpp"

/// What the state of an interface, and what was heard on it, say of a CAN bus. Rules without I/O.
namespace servoctl::traffic {

/// What is known of one interface.
struct LinkFacts {
  std::string name;
  can::LinkState state;                       ///< After the listening.
  std::optional<can::LinkState> before = {};  ///< And before it.
  std::string driver = {};
  std::optional<bool> may_change = {};
  std::size_t receivers = 0;  ///< Sockets of other programs that receive from it.
};

/// Of the interface itself: up, state, bitrate, sample point, restart, queue, rights.
std::vector<Finding> link_findings(const LinkFacts& facts);

/// Of the bus: who talks, and what goes wrong on the wire. `facts` is null where there is no controller, as
/// on `local:` and `sim:`; the bus then has this URL.
std::vector<Finding> bus_findings(const BusPicture& picture, const LinkFacts* facts,
                                  std::string_view url = {});

/// Adds that CAN FD frames came, in these words: such a bus is not silent.
void add_fd_frames(std::vector<Finding>& findings, std::string text);

/// Where there is no interface at all. `serial`: the ports of can::serial_adapters().
std::vector<Finding> no_interface_findings(bool kernel_has_can, const std::vector<std::string>& serial);

}  // namespace servoctl::traffic
