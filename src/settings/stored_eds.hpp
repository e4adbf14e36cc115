#pragma once

#include <optional>
#include <string>

#include "base/result.hpp"
#include "session/identity.hpp"
#include "session/object_survey.hpp"
#include "show/desk.hpp"

namespace servoctl::settings {

/// The text of the EDS that the drive with this identity stores (1021h, in the format of 1022h). Empty if it
/// has none, or one that is no EDS or is for another vendor or product, which goes to the notices of the
/// desk. The errors of ObjectSurvey::read().
Result<std::optional<std::string>> stored_eds(show::Desk& desk, session::ObjectSurvey& survey,
                                              const session::Identity& identity);

}  // namespace servoctl::settings
