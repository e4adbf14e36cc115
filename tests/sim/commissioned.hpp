#pragma once

#include "sim/cell.hpp"

namespace servoctl::sim {

/// Sets on the panel, before the drive has power, what its family needs to obey the bus: as delivered some do
/// not.
inline void commission(DriveModel& model) {
  for (const auto& need : model.profile().rules.nmt.needs) (void)model.set_on_panel(need.name, need.value);
}
inline void commission(Cell& cell) {
  for (const auto& drive : cell.drives) commission(drive->model());
}

}  // namespace servoctl::sim
