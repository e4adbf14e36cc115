#pragma once

#include <string>

#include "report/value.hpp"

namespace servoctl::report {

/// The value in one line, as it stands in a cell of a table: `-` for nothing, `pp, pv` for a list. Control
/// characters are not written out.
std::string line_text(const Value& value);

}  // namespace servoctl::report
