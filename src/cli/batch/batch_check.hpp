#pragma once

#include <span>
#include <vector>

#include "cli/batch/batch_plan.hpp"
#include "cli/shell.hpp"

namespace servoctl::cli {

/// What is wrong in the steps, each with its line: commands, options, nodes, names and values against the
/// drive's dictionary. Opens no bus. What only a drive can tell (the size of an object no table knows, the
/// meaning of a unit by its gear) is left to the run.
std::vector<Error> check_steps(Shell& shell, std::span<const Step> steps);

}  // namespace servoctl::cli
