#pragma once

#include "drive/naming.hpp"

namespace servoctl::drive {

/// Whether the unit of the object is a position unit of the drive, or a rate of it, that CiA 402-2
/// recommends, and nothing in the data says that this drive uses it: no number may be converted by it.
bool is_unit_assumed(const Target& target);

/// Whether such units are those of CiA 402 for any drive, and not of a family whose manual was read: they are
/// left open unless the drive names its own.
bool leaves_units_open(const Profile& profile);

}  // namespace servoctl::drive
