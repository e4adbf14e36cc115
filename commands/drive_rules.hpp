#pragma once

#include "drive/profile.hpp"
#include "report/value.hpp"

namespace servoctl::commands {

/// All rules of a family, for `drives FAMILY`.
report::Record rules_record(const drive::Profile& profile, bool chinese);

}  // namespace servoctl::commands
