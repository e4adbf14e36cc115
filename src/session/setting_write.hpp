#pragma once

#include "drive/profile.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// The write of one value that the family's rules name, in the type of its object. Errc::usage for a name
/// that the family has not, or a value that does not fit the type.
Result<SdoRequest> setting_write(const drive::Profile& profile, std::uint8_t node,
                                 const drive::Setting& setting);

}  // namespace servoctl::session
