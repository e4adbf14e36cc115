#pragma once

#include <span>

#include "base/result.hpp"
#include "drive/naming.hpp"
#include "session/session.hpp"
#include "show/desk.hpp"

namespace servoctl::show {

/// Asks before reads that raise an alarm on the drive, because its family's data lack the object
/// (session::access_alarm()), and marks them to be sent. Where the family that the user named contradicts the
/// drive they are not asked for, and not sent. Errc::refused if nobody agrees.
Result<void> confirm_alarms(const Desk& desk, std::span<session::SdoRequest> requests);

/// Asks before requests for parameters that a numbering gives an object and no table lists: if the drive does
/// not have one, the request raises an alarm (drive::possible_alarm()). Errc::refused if nobody agrees.
Result<void> confirm_unlisted(const Desk& desk, std::uint8_t node, std::span<const drive::Target> targets);

}  // namespace servoctl::show
