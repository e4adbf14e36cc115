#pragma once

#include <cstdint>
#include <set>

#include "od/eds.hpp"

namespace servoctl::drive {

/// What the standard says of an index; of an index of the profile (6000h to 9FFFh) only if its axis is one of
/// CiA 402. Null: nothing.
const od::Object* standard_object(const od::Dictionary& standard, std::uint16_t index, bool is_of_drive);

/// The entries of a sheet that was learned (od::EdsFile::learned) of which nobody knows whether they can be
/// written: they are `ro` in it, and `standard` does not say so. Of other sheets none. Without a standard
/// only entries of the maker (2000h to 5FFFh).
std::set<ObjectAddress> unknown_access(const od::EdsFile& sheet, const od::Dictionary& standard);

}  // namespace servoctl::drive
