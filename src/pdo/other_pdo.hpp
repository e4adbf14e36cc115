#pragma once

#include <string>

#include "pdo/pdo_changing.hpp"

namespace servoctl::pdo {

/// Where a drive refused a change because what a PDO carries is fixed (read-only): a hint with the command
/// that takes another PDO of the same direction, if possible one that is not in use. Empty where there is
/// none, or where it was refused for another reason.
std::string other_pdo_hint(const drive::Profile& profile, const PresentPdos& present,
                           const WantedPdos& wanted, const Error& failure);

}  // namespace servoctl::pdo
