#pragma once

#include <span>
#include <string>

#include "cli/batch/batch_plan.hpp"
#include "cli/shell.hpp"

namespace servoctl::cli {

/// What `run --dry-run --frames` says: every line, and the frames that it would send to the drives as they
/// are now. `dry_run` holds among the defaults of the shell. A line that would be refused has its error, and
/// the others are gone through all the same.
Outcome planned_frames(Shell& shell, std::span<const Step> steps, const std::string& file);

}  // namespace servoctl::cli
