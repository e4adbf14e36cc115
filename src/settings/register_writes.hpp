#pragma once

#include <span>
#include <string_view>

#include "session/write.hpp"
#include "settings/change.hpp"
#include "show/desk.hpp"

namespace servoctl::settings {

/// On Modbus, before anything is written: Errc::sdo_abort for a change of what has no register, Errc::usage
/// for one that does not go into a register, and for the unit address 0, by which nobody answers.
Result<void> check_registers(const show::Desk& desk, std::span<const Change> changes);

/// On Modbus: why to ask before a change of address, speed or framing; empty for any other.
std::string_view register_reason(const show::Desk& desk, const Change& change);

/// On Modbus: an answer says that a write came, not that the drive took it; actions have no value to read.
bool is_only_echoed(const show::Desk& desk, std::span<const Change> changes);

/// Where no statusword is (Modbus): says in `desk.notices` of which nodes a parameter that is 0 at rest, or a
/// target, was written otherwise, or may have been, because nothing that servoctl does stops or disables them
/// then. `written` is in the order of `changes`.
void tell_not_at_rest(show::Desk& desk, std::span<const Change> changes,
                      std::span<const Result<session::Written>> written);

/// Whether tell_not_at_rest() speaks of this object.
bool is_told_not_at_rest(const show::Desk& desk, ObjectAddress object);

}  // namespace servoctl::settings
