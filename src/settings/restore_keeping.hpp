#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "drive/profile.hpp"
#include "session/write_plan.hpp"

namespace servoctl::settings {

/// Why it is not known that what is written of these values survives power-off once the drive has been told
/// to keep it: what session::is_known_to_keep() does not know of, and what the drive replaces at its start by
/// a parameter (od::Parameter::mirror) that says otherwise, written now or not. One sentence a reason;
/// `title` names the file. Empty where the family cannot store at all: that is refused elsewhere.
std::vector<Message> doubts_of_keeping(const drive::Profile& profile, std::uint8_t node, const Message& title,
                                       const session::Values& present, const session::Values& wanted);

}  // namespace servoctl::settings
