#pragma once

#include <string>
#include <string_view>

#include "canopen/sdo_observer.hpp"

namespace servoctl::traffic {

/// The name of a step in JSON: `read`, `write`, `answer` …
std::string_view step_name(canopen::SdoStep::Kind kind);
/// What happens to the object, before its value; `abort` are the words for the abort code.
std::string step_text(const canopen::SdoStep& step, const std::string& object, std::string_view abort,
                      bool chinese);

}  // namespace servoctl::traffic
