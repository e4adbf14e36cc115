#pragma once

#include <optional>
#include <string_view>

#include "drive/profile.hpp"
#include "show/explanation.hpp"

namespace servoctl::traffic {

/// A CAN frame that somebody typed or pasted, `581#8002650000000206`, also as a whole line of candump, in
/// words; empty where it is none. `profile` names objects and faults.
std::optional<show::Explanation> explained_frame(std::string_view text, const drive::Profile& profile);

}  // namespace servoctl::traffic
