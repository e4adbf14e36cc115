#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cabinet/cabinet_plan.hpp"

namespace servoctl::cabinet {

/// The drive of an axis, known by its serial number, at another node than the file says.
struct Displaced {
  std::size_t look = 0;  ///< Number of its look, and of its station.
  std::uint8_t at = 0;   ///< Where it is.
  std::uint32_t serial = 0;
};

/// Looks for the drives of axes whose node is empty, or has another drive than the serial number of the file
/// says: at every other node of the bus (CAN alone) whose axis is not as the file says. Only reads, and only
/// where an axis is missing. Their looks say where they are then (Errc::negative: `apply` gives them their
/// node).
std::vector<Displaced> find_displaced(const show::Desk& desk, std::span<const Station> stations,
                                      const PlanChoice& choice, std::span<PlannedAxis> looks);

/// Finds them, asks, and gives each its node by its family's parameter, as `address` does it: written, read
/// back, stored, restarted, found again; then it is looked at anew. What keeps one from it is the error of
/// its look. Errc::refused when nobody agreed: nothing was written.
Result<void> place_displaced(const show::Desk& desk, const Cabinet& cabinet,
                             std::span<const Station> stations, const PlanChoice& choice, bool unlock,
                             std::span<PlannedAxis> looks);

}  // namespace servoctl::cabinet
