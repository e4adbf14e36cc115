#pragma once

#include <memory>
#include <string_view>

#include "base/object_address.hpp"
#include "drive/profile.hpp"

namespace servoctl::drive {

/// The panel text of the alarm that a drive of this family raises when an SDO asks for the object: its data
/// have no such object ([fault] object_alarm), or no such sub-index (sub_index_alarm). Empty: the data have
/// it, the family has no such alarms, or a numbering with `unlisted` gives the object a parameter number.
std::string_view access_alarm(const Profile& profile, ObjectAddress object);

/// The same, and also where a numbering with `unlisted` gives the object a parameter number: whether the
/// drive has that parameter is not known, and the alarm comes if it has not.
std::string_view possible_alarm(const Profile& profile, ObjectAddress object);

/// Whether the object takes the power of a drive away, or shows that it is gone: such a request is always
/// sent. An alarm costs less than a drive that stays energised, whatever a file of the user's own lists.
bool stops_a_drive(ObjectAddress object);

/// Whether the family has such alarms.
bool has_access_alarms(const Rules& rules);
/// The rules of a family that has such alarms; null where it has none, or its rules cannot be read. Most have
/// none, and their files are only searched for the words.
std::shared_ptr<const Rules> alarm_rules(const Family& family);

}  // namespace servoctl::drive
