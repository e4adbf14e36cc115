#pragma once

#include <span>

#include "cabinet/cabinet.hpp"
#include "show/desk.hpp"

namespace servoctl::cabinet {

/// What the file says of an axis and whether its drive holds it, for a report: `{file bus groups[] serial
/// turn encoder load limits{speed torque window following_error} heartbeat_ms pdos compared different
/// values[{index sub id name wanted present held}]}`. Reads, writes nothing; errors as plan_axis().
Result<report::Value> axis_sheet(show::Desk& desk, const Cabinet& cabinet, const Axis& axis,
                                 std::span<const drive::Family> families);

/// `20 mm/rev`; empty where the load has no unit of its own.
std::string load_text(const Axis& axis);
/// The preset, the file or how many PDOs; null where the file says none.
report::Value pdos_text(const Axis& axis);

}  // namespace servoctl::cabinet
