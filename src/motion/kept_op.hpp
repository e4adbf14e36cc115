#pragma once

#include <cstdint>

#include "base/result.hpp"
#include "session/session.hpp"

namespace servoctl::motion {

/// The user had this drive, which has no power now, in OP: it goes there anew, so that every output is
/// preset, 607Ah from where it stands. One that has left OP by itself is not taken there again. An error has
/// the whole sentence: in which state it is now, and why.
Result<void> renew_op(session::Session& session, std::uint8_t node);

}  // namespace servoctl::motion
