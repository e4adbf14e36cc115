#include "drive/access_alarms.hpp"

#include <algorithm>

#include "drive/standard_objects.hpp"

namespace servoctl::drive {
namespace {

/// Whether a numbering gives the object a parameter number although the parameter table may not list it.
bool has_unlisted_number(const Rules& rules, ObjectAddress object) {
  constexpr unsigned kRange = 0xF000;
  return std::any_of(rules.numbering.begin(), rules.numbering.end(), [&](const Numbering& rule) {
    return rule.unlisted && object.sub == rule.first_sub && (object.index & kRange) == (rule.index & kRange);
  });
}

/// What takes the power of a drive away, and shows that it is gone: an alarm costs less than a drive that
/// stays energised, whatever a file of the user's own lists.
bool stops_a_drive(ObjectAddress object) {
  constexpr ObjectAddress kStopping[] = {objects::kControlword, objects::kStatusword,
                                         objects::kModeOfOperation, objects::kModeDisplay,
                                         objects::kTargetVelocity};
  return std::ranges::find(kStopping, object) != std::end(kStopping);
}

}  // namespace

bool has_access_alarms(const Rules& rules) {
  return !rules.fault.object_alarm.empty() || !rules.fault.sub_index_alarm.empty();
}

std::string_view access_alarm(const Profile& profile, ObjectAddress object) {
  const auto& rules = profile.rules;
  if (!has_access_alarms(rules) || stops_a_drive(object) || profile.dictionary.find(object) != nullptr ||
      has_unlisted_number(rules, object))
    return {};
  const bool has_index = profile.dictionary.object(object.index) != nullptr;
  return has_index ? rules.fault.sub_index_alarm : rules.fault.object_alarm;
}

}  // namespace servoctl::drive
