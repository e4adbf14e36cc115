#pragma once

#include "report/value.hpp"

namespace servoctl::command {

/// What one command answers for one drive; of a list the one it has. The node stands in the heading: people
/// do not see it again.
report::Value of_one_drive(report::Value value);

}  // namespace servoctl::command
