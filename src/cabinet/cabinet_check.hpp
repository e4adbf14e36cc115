#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cabinet/cabinet.hpp"
#include "drive/profile.hpp"

namespace servoctl::cabinet {

/// The data of a family or a file; errors as drive::load_profile().
using LoadProfile = std::function<Result<const drive::Profile*>(const std::string& family)>;

/// What is wrong with one axis, as far as it can be told without its drive: family, names and values of its
/// parameters, two values for one object, PDOs, heartbeat, units of its limits. Each error has file, line and
/// column; empty: nothing.
std::vector<Error> check_axis(const Cabinet& cabinet, const Axis& axis, const LoadProfile& load);

/// The same of all axes; what a group or a family says wrong is told once.
std::vector<Error> check_cabinet(const Cabinet& cabinet, const LoadProfile& load);

}  // namespace servoctl::cabinet
