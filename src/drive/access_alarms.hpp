#pragma once

#include <string_view>

#include "base/object_address.hpp"
#include "drive/profile.hpp"

namespace servoctl::drive {

/// The panel text of the alarm that a drive of this family raises when an SDO asks for the object: its data
/// have no such object ([fault] object_alarm), or no such sub-index (sub_index_alarm). Empty: the data have
/// it, the family has no such alarms, or a numbering with `unlisted` gives the object a parameter number.
std::string_view access_alarm(const Profile& profile, ObjectAddress object);

/// Whether the family has such alarms.
bool has_access_alarms(const Rules& rules);

}  // namespace servoctl::drive
