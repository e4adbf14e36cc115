#include "drive/assumed_unit.hpp"

#include <algorithm>

#include "drive/profile.hpp"
#include "drive/scaling.hpp"

namespace servoctl::drive {

bool is_unit_assumed(const Target& target) {
  if (target.parameter != nullptr || target.entry == nullptr) return false;
  const auto& entry = *target.entry;
  const auto& assumed = entry.doubts.assumed;
  return needed_measure(entry.unit, target.address) == Measure::increments_per_turn &&
         std::any_of(assumed.begin(), assumed.end(),
                     [](const od::Mark& mark) { return mark.field == "unit"; });
}

bool leaves_units_open(const Profile& profile) {
  return profile.is_generic() || profile.descends_from(kGenericFamily);
}

}  // namespace servoctl::drive
