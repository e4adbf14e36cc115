#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "drive/profile.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// What one drive is to be asked.
struct MeasureQuestion {
  std::uint8_t node = 0;
  drive::Measure measure = drive::Measure::increments_per_turn;

  bool operator==(const MeasureQuestion&) const = default;
};

/// Reads gear, encoder and rating objects of drives, as the family's rules say (`[units]`): increments in one
/// turn of the motor, rated torque in Nm. Empty where the rules do not know the measure, or the drive does
/// not answer an object of it.
std::vector<std::optional<double>> read_measures(Session& session, const drive::Profile& profile,
                                                 std::span<const MeasureQuestion> questions);

}  // namespace servoctl::session
