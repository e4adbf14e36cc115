#pragma once

#include <cstdint>
#include <span>

#include "report/value.hpp"
#include "session/scan.hpp"
#include "show/desk.hpp"

namespace servoctl::show {

/// Units of Modbus that answered, with the alarm of each where a family was named: nothing else tells what
/// they are.
report::Table register_scan(Desk& desk, std::span<const session::Identity> found);

/// What a unit has instead of an identity: the parameters that its family shows, its inputs and outputs.
/// Errc::timeout when it does not answer.
Result<report::Value> register_info(Desk& desk, std::uint8_t node);

}  // namespace servoctl::show
