#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cabinet/cabinet.hpp"
#include "drive/profile.hpp"

namespace servoctl::cabinet {

/// The data of a family or a file; errors as drive::load_profile().
using LoadProfile = std::function<Result<const drive::Profile*>(const std::string& family)>;

struct CabinetFindings {
  std::vector<Error> errors;     ///< Each with file, line and column.
  std::vector<Message> notices;  ///< No fault, and worth a look: objects that no manual lists.
};

/// What is wrong with the axes, as far as it can be told without their drives: family, names and values of
/// parameters, two values for one object, PDOs, heartbeat, limits. What a group or a family says wrong is
/// told once.
CabinetFindings check_cabinet(const Cabinet& cabinet, const LoadProfile& load);

}  // namespace servoctl::cabinet
