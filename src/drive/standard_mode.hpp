#pragma once

#include <cstdint>
#include <string>

#include "drive/profile.hpp"

namespace servoctl::drive {

/// The mode of CiA 402-2 that a value of 6060h or 6061h is in a family: its bits in statusword and
/// controlword mean what the standard says of that mode. 0 where the family counts its modes in a way of its
/// own and none of its rules says what this one is.
std::int8_t standard_mode(const MotionRules& rules, std::int8_t mode);

/// A short word for the mode: the standard's abbreviation (`pv`), or what a family that counts its modes in a
/// way of its own calls this one; empty where there is none. `profile` may be null.
std::string mode_word(const Profile* profile, std::int8_t mode, bool chinese);

}  // namespace servoctl::drive
