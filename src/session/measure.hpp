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
  /// The number that no object of this drive tells (drive::Quotient::learned), where it is known.
  std::optional<double> learned = {};

  bool operator==(const MeasureQuestion&) const = default;
};

struct Measured {
  double value = 0;
  bool learned = false;                  ///< MeasureQuestion::learned went into it.
  const drive::Quotient* way = nullptr;  ///< Of the profile's rules, the one whose conditions hold.
};

/// Reads gear, encoder and rating objects of drives, as the family's rules say (`[units]`): increments in one
/// turn of the motor, rated torque in Nm. Empty where the rules do not know the measure, or the drive does
/// not answer an object of it, or nobody knows the number that it does not tell. An answer that was lost is
/// no object that is missing: `unanswered` gets its error, where it is not null.
std::vector<std::optional<Measured>> read_measures(Session& session, const drive::Profile& profile,
                                                   std::span<const MeasureQuestion> questions,
                                                   std::optional<Error>* unanswered = nullptr);

}  // namespace servoctl::session
