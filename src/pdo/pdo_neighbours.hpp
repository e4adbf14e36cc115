#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "canopen/pdo.hpp"
#include "show/desk.hpp"

namespace servoctl::pdo {

/// The PDOs of one node before and after a change.
struct PdoNeighbour {
  std::uint8_t node = 0;
  std::vector<canopen::Pdo> present;
  std::vector<canopen::Pdo> wanted;
};

/// Whether the CAN-IDs that a change gives to PDOs are free on the bus: among the nodes that change, and at
/// the node whose PDO stands there in the pre-defined connection set (CiA 301, 7.3.5), which is asked. Two
/// TPDOs with one CAN-ID collide, and a CAN-ID that another RPDO has commands two drives at once.
/// Errc::refused. An RPDO that receives another node's TPDO is a link, and reported as a notice.
Result<void> check_neighbours(show::Desk& desk, std::span<const PdoNeighbour> nodes);

}  // namespace servoctl::pdo
