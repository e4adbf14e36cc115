#pragma once

#include <span>

#include "session/write.hpp"
#include "settings/change.hpp"
#include "show/desk.hpp"

namespace servoctl::settings {

/// On Modbus: Errc::sdo_abort for a change of what has no register, before anything is written.
Result<void> check_registers(const show::Desk& desk, std::span<const Change> changes);

/// Where no statusword is (Modbus): says in `desk.notices` of which nodes a parameter that is 0 at rest was
/// written otherwise, because nothing that servoctl does stops or disables them then. `written` is in the
/// order of `changes`.
void tell_not_at_rest(show::Desk& desk, std::span<const Change> changes,
                      std::span<const Result<session::Written>> written);

}  // namespace servoctl::settings
